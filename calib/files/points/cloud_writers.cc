#include <limits>

#include "calib/files/atomic_file.h"
#include "calib/files/points/cloud_files.h"
#include "calib/files/points/internal/fused_comments.h"
#include "calib/files/points/internal/records.h"
#include "calib/model/errors.h"

namespace rgbdt {
namespace {

using records::Column;
using records::MakeColumn;

void RequireLength(std::size_t have, std::size_t need, const std::string& what,
                   const std::filesystem::path& path) {
  if (have == need) return;
  throw InputError("cannot write " + path.string() + ": the cloud has " + std::to_string(need) +
                   " points but " + std::to_string(have) + " values of " + what);
}

void AddVectors(const std::string& prefix, const std::vector<Eigen::Vector3f>& vectors,
                std::size_t points_per_vector, std::vector<Column>* columns) {
  for (int axis = 0; axis < 3; ++axis) {
    columns->push_back(
        MakeColumn<float>(prefix + "xyz"[axis], [&vectors, axis, points_per_vector](std::size_t i) {
          return vectors[i / points_per_vector][axis];
        }));
  }
}

std::vector<Eigen::Vector3f> AllDirections(const Cloud& cloud) {
  std::vector<Eigen::Vector3f> directions(cloud.directions.size());
  for (std::size_t i = 0; i < directions.size(); ++i) directions[i] = DirectionOf(cloud, i);
  return directions;
}

std::string PcdBytes(const std::vector<Column>& columns, std::size_t width, std::size_t height,
                     const std::vector<std::string>& comments) {
  std::string fields, sizes, types, counts;
  for (const Column& column : columns) {
    fields += " " + column.name;
    sizes += " " + std::to_string(column.size);
    types += std::string(" ") + column.type;
    counts += " 1";
  }
  std::string header = "# .PCD v0.7 - Point Cloud Data file format\n";
  for (const std::string& comment : comments) header += "# " + comment + "\n";
  return header + "VERSION 0.7\nFIELDS" + fields + "\nSIZE" + sizes + "\nTYPE" + types + "\nCOUNT" +
         counts + "\nWIDTH " + std::to_string(width) + "\nHEIGHT " + std::to_string(height) +
         "\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + std::to_string(width * height) + "\nDATA binary\n" +
         records::Pack(columns, width * height);
}

void CheckCloud(const Cloud& cloud, const std::filesystem::path& path) {
  const std::size_t n = cloud.size();
  if (n == 0) throw InputError("cannot write " + path.string() + ": the cloud has no points");
  const auto optional = [&](std::size_t have, const char* what) {
    if (have > 0) RequireLength(have, n, what, path);
  };
  optional(cloud.directions.size(), "direction");
  optional(cloud.intensity.size(), "intensity");
  optional(cloud.utime.size(), "utime");
  optional(cloud.ring.size(), "ring");
  const std::size_t lines =
      cloud.organised ? static_cast<std::size_t>(std::max(cloud.lines, 0)) : 1;
  if (cloud.organised) {
    RequireLength(lines * static_cast<std::size_t>(std::max(cloud.beams, 0)), n, "line x beam",
                  path);
  }
  if (!cloud.origins.empty() && cloud.origins.size() != lines) {
    throw InputError("cannot write " + path.string() + ": the cloud has " + std::to_string(lines) +
                     " lines but " + std::to_string(cloud.origins.size()) + " origins");
  }
}

void CheckCloud(const RgbdtCloud& cloud, const std::filesystem::path& path) {
  const std::size_t n = cloud.size();
  RequireLength(cloud.intensity.size(), n, "intensity", path);
  RequireLength(cloud.utime.size(), n, "utime", path);
  RequireLength(cloud.rgb.size(), n, "rgb", path);
  RequireLength(cloud.temperature_k.size(), n, "temperature", path);
  RequireLength(cloud.temperature_sigma_k.size(), n, "temperature's sigma", path);
  RequireLength(cloud.thermal_counts.size(), n, "thermal counts", path);
  RequireLength(cloud.valid.size(), n, "valid", path);
  if (cloud.calibration_utime.size() != cloud.cameras.size()) {
    throw InputError("cannot write " + path.string() + ": the cloud has " +
                     std::to_string(cloud.cameras.size()) + " cameras but " +
                     std::to_string(cloud.calibration_utime.size()) + " times of calibrations");
  }
}

// Red, green and blue in the three lower bytes of an integer that PCL calls a float.
std::uint32_t PackRgb(const std::array<std::uint8_t, 3>& rgb) {
  return (std::uint32_t{rgb[0]} << 16) | (std::uint32_t{rgb[1]} << 8) | rgb[2];
}

// What PCD and PLY have in common, after the colour.
void AddMeasurements(const RgbdtCloud& cloud, std::vector<Column>* columns) {
  const auto add = [columns](const char* name, const std::vector<float>& values) {
    columns->push_back(MakeColumn<float>(name, [&values](std::size_t i) { return values[i]; }));
  };
  add("intensity", cloud.intensity);
  columns->push_back(MakeColumn<double>("utime", [&](std::size_t i) { return cloud.utime[i]; }));
  add("temperature", cloud.temperature_k);
  add("temperature_sigma", cloud.temperature_sigma_k);
  add("thermal_counts", cloud.thermal_counts);
  columns->push_back(
      MakeColumn<std::uint32_t>("valid", [&](std::size_t i) { return cloud.valid[i]; }));
}

std::string PlyType(const Column& column) {
  if (column.type == 'F') return column.size == 8 ? "double" : "float";
  return column.size == 1 ? "uchar" : "uint";
}

}  // namespace

void WritePcd(const std::filesystem::path& path, const Cloud& cloud) {
  CheckCloud(cloud, path);
  const std::size_t beams = cloud.organised ? static_cast<std::size_t>(cloud.beams) : cloud.size();
  std::vector<Column> columns;
  AddVectors("", cloud.points, 1, &columns);
  if (!cloud.intensity.empty()) {
    columns.push_back(
        MakeColumn<float>("intensity", [&](std::size_t i) { return cloud.intensity[i]; }));
  }
  if (!cloud.ring.empty()) {
    columns.push_back(
        MakeColumn<std::uint16_t>("ring", [&](std::size_t i) { return cloud.ring[i]; }));
  }
  if (!cloud.utime.empty()) {
    columns.push_back(MakeColumn<double>("utime", [&](std::size_t i) { return cloud.utime[i]; }));
  }
  if (cloud.organised) {
    columns.push_back(MakeColumn<std::int32_t>("line", [&cloud, beams](std::size_t i) {
      return static_cast<std::size_t>(cloud.first_line) + i / beams;
    }));
    columns.push_back(
        MakeColumn<std::int32_t>("beam", [beams](std::size_t i) { return i % beams; }));
  }
  const std::vector<Eigen::Vector3f> directions = AllDirections(cloud);
  if (!directions.empty()) AddVectors("dir_", directions, 1, &columns);
  if (!cloud.origins.empty()) AddVectors("origin_", cloud.origins, beams, &columns);
  WriteFileAtomically(
      path, PcdBytes(columns, beams, cloud.size() / beams,
                     {"LIDAR frame: x forward, y left, z up [m]; NaN: the beam returned nothing"}));
}

void WritePcd(const std::filesystem::path& path, const RgbdtCloud& cloud) {
  CheckCloud(cloud, path);
  std::vector<Column> columns;
  AddVectors("", cloud.points, 1, &columns);
  columns.push_back(
      MakeColumn<std::uint32_t>("rgb", [&](std::size_t i) { return PackRgb(cloud.rgb[i]); }));
  columns.back().type = 'F';
  AddMeasurements(cloud, &columns);
  WriteFileAtomically(path, PcdBytes(columns, cloud.size(), 1, FusedComments(cloud)));
}

void WritePly(const std::filesystem::path& path, const RgbdtCloud& cloud) {
  CheckCloud(cloud, path);
  std::vector<Column> columns;
  AddVectors("", cloud.points, 1, &columns);
  const char* const names[] = {"red", "green", "blue"};
  for (std::size_t c = 0; c < 3; ++c) {
    columns.push_back(
        MakeColumn<std::uint8_t>(names[c], [&cloud, c](std::size_t i) { return cloud.rgb[i][c]; }));
  }
  AddMeasurements(cloud, &columns);
  std::string header = "ply\nformat binary_little_endian 1.0\n";
  for (const std::string& comment : FusedComments(cloud)) header += "comment " + comment + "\n";
  header += "element vertex " + std::to_string(cloud.size()) + "\n";
  for (const Column& column : columns) {
    header += "property " + PlyType(column) + " " + column.name + "\n";
  }
  WriteFileAtomically(path, header + "end_header\n" + records::Pack(columns, cloud.size()));
}

}  // namespace rgbdt
