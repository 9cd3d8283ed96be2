#include <algorithm>
#include <cmath>
#include <limits>

#include "calib/files/atomic_file.h"
#include "calib/files/points/cloud_files.h"
#include "calib/files/points/internal/fused_comments.h"
#include "calib/files/points/internal/pcd_table.h"
#include "calib/files/points/internal/ply_table.h"
#include "calib/files/points/internal/point_columns.h"
#include "calib/model/errors.h"

namespace rgbdt {
namespace {

using Names = std::vector<std::string>;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

// The first of these fields that the file has; NaN where it has none.
std::vector<float> ReadFloats(const records::Table& table, const Names& names) {
  for (const std::string& name : names) {
    if (!table.Has(name)) continue;
    const std::vector<double> values = table.Column(name);
    return {values.begin(), values.end()};
  }
  return std::vector<float>(table.size(), kNan);
}

// One of the three colours: 0 to 255, or, as a real number, 0 to 1.
std::vector<std::uint8_t> ReadShade(const records::Table& table, const std::string& name) {
  std::vector<double> values = table.Column(name);
  const bool unit = table.TypeOf(name) == 'F' &&
                    std::all_of(values.begin(), values.end(), [](double v) { return !(v > 1); });
  std::vector<std::uint8_t> shades;
  shades.reserve(values.size());
  for (const double value : values) {
    const double shade = std::isnan(value) ? 0 : (unit ? 255 : 1) * value;
    shades.push_back(static_cast<std::uint8_t>(std::lround(std::clamp(shade, 0.0, 255.0))));
  }
  return shades;
}

using Rgb = std::vector<std::array<std::uint8_t, 3>>;

Rgb ReadRgb(const records::Table& table) {
  Rgb rgb(table.size(), {0, 0, 0});
  for (const char* packed : {"rgb", "rgba"}) {
    if (!table.Has(packed)) continue;
    const std::vector<std::uint32_t> bits = table.Bits(packed);
    for (std::size_t i = 0; i < rgb.size(); ++i) {
      for (std::size_t c = 0; c < 3; ++c) {
        rgb[i][c] = static_cast<std::uint8_t>(bits[i] >> (16 - 8 * c));
      }
    }
    return rgb;
  }
  for (const Names& names : {Names{"red", "green", "blue"}, Names{"r", "g", "b"},
                             Names{"diffuse_red", "diffuse_green", "diffuse_blue"}}) {
    if (!table.Has(names[0]) || !table.Has(names[1]) || !table.Has(names[2])) continue;
    for (std::size_t c = 0; c < 3; ++c) {
      const std::vector<std::uint8_t> shades = ReadShade(table, names[c]);
      for (std::size_t i = 0; i < rgb.size(); ++i) rgb[i][c] = shades[i];
    }
    return rgb;
  }
  return rgb;
}

// Without names of cameras its bits mean nothing.
std::vector<std::uint32_t> ReadValid(const records::Table& table, std::size_t cameras,
                                     const std::string& where) {
  std::vector<std::uint32_t> valid(table.size(), 0);
  if (cameras == 0 || !table.Has("valid")) return valid;
  const std::vector<double> values = table.Column("valid");
  const double most = std::exp2(static_cast<double>(cameras)) - 1;
  for (std::size_t i = 0; i < valid.size(); ++i) {
    if (!(values[i] >= 0 && values[i] <= most)) {
      throw InputError(where + ": point " + std::to_string(i + 1) + ": valid is " +
                       std::to_string(values[i]) + "; expected bits of the " +
                       std::to_string(cameras) + " cameras named");
    }
    valid[i] = static_cast<std::uint32_t>(values[i]);
  }
  return valid;
}

// Keeps what belongs to the points that are marked.
template <typename T>
void Keep(const std::vector<bool>& marked, std::vector<T>* values) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < values->size(); ++i) {
    if (marked[i]) (*values)[kept++] = (*values)[i];
  }
  values->resize(kept);
}

// A fused cloud holds what returned; a beam that did not is NaN or, as drivers write it, 0 0 0.
void DropMisses(const std::string& where, RgbdtCloud* cloud) {
  std::vector<bool> hit;
  hit.reserve(cloud->size());
  for (const Eigen::Vector3f& p : cloud->points) hit.push_back(p.allFinite() && !p.isZero(0));
  const auto hits = std::count(hit.begin(), hit.end(), true);
  if (hits == static_cast<std::ptrdiff_t>(hit.size())) return;
  if (hits == 0) {
    throw InputError(where + ": none of its " + std::to_string(hit.size()) +
                     " points holds finite coordinates");
  }
  Keep(hit, &cloud->points);
  Keep(hit, &cloud->intensity);
  Keep(hit, &cloud->utime);
  Keep(hit, &cloud->rgb);
  Keep(hit, &cloud->temperature_k);
  Keep(hit, &cloud->temperature_sigma_k);
  Keep(hit, &cloud->thermal_counts);
  Keep(hit, &cloud->valid);
}

RgbdtCloud Assemble(const std::vector<std::string>& comments, const records::Table& table,
                    const std::string& where) {
  RgbdtCloud cloud;
  ReadFusedComments(comments, where, &cloud);
  cloud.points = ReadVectors(table, "x", "y", "z");
  cloud.intensity = table.Has("intensity") ? ReadIntensity(table) : ReadFloats(table, {});
  cloud.utime = ReadUtime(table, cloud.sweep_utime, where);
  if (cloud.utime.empty()) cloud.utime.assign(table.size(), cloud.sweep_utime);
  cloud.rgb = ReadRgb(table);
  cloud.temperature_k = ReadFloats(table, {"temperature", "temperature_k"});
  cloud.temperature_sigma_k = ReadFloats(table, {"temperature_sigma", "temperature_sigma_k"});
  cloud.thermal_counts = ReadFloats(table, {"thermal_counts"});
  cloud.valid = ReadValid(table, cloud.cameras.size(), where);
  DropMisses(where, &cloud);
  return cloud;
}

}  // namespace

RgbdtCloud ReadFused(const std::filesystem::path& path) {
  return ParseFused(ReadWholeFile(path, kMostPointsBytes), path.string());
}

RgbdtCloud ParseFused(const std::string& bytes, const std::string& where) {
  if (bytes.compare(0, 3, "ply") == 0) {
    const ply::File file = ply::Parse(bytes, where);
    return Assemble(file.comments, file.table, where);
  }
  const pcd::File file = pcd::Parse(bytes, where);
  return Assemble(file.header.comments, file.table, where);
}

}  // namespace rgbdt
