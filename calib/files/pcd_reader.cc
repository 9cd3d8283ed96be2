#include <algorithm>
#include <cmath>
#include <limits>

#include "calib/files/atomic_file.h"
#include "calib/files/cloud_files.h"
#include "calib/files/pcd_table.h"
#include "calib/model/errors.h"

namespace rgbdt {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
// A time in seconds above this (1973) is one since 1970, below it one since the sweep's start.
constexpr double kAbsoluteSeconds = 1e8;

std::vector<Eigen::Vector3f> ReadVectors(const pcd::Table& table, const std::string& x,
                                         const std::string& y, const std::string& z) {
  const std::vector<double> xs = table.Column(x), ys = table.Column(y), zs = table.Column(z);
  std::vector<Eigen::Vector3f> vectors;
  vectors.reserve(xs.size());
  for (std::size_t i = 0; i < xs.size(); ++i) {
    vectors.emplace_back(static_cast<float>(xs[i]), static_cast<float>(ys[i]),
                         static_cast<float>(zs[i]));
  }
  return vectors;
}

// No beam returns from the sensor's own centre: (0, 0, 0) is how many drivers write a miss.
void MarkMisses(std::vector<Eigen::Vector3f>* points, const std::string& where) {
  std::size_t hits = 0;
  for (Eigen::Vector3f& point : *points) {
    if (point.allFinite() && !point.isZero(0)) {
      ++hits;
    } else {
      point.setConstant(kNan);
    }
  }
  if (hits == 0) {
    throw InputError(where + ": none of its " + std::to_string(points->size()) +
                     " points holds finite coordinates");
  }
}

std::vector<float> ReadIntensity(const pcd::Table& table) {
  const std::vector<double> values = table.Column("intensity");
  double largest = 0;
  for (const double value : values) {
    if (std::isfinite(value)) largest = std::max(largest, value);
  }
  const double one = largest <= 1 ? 1 : largest <= 255 ? 255 : std::max(largest, 65535.0);
  std::vector<float> intensity;
  intensity.reserve(values.size());
  for (const double value : values) {
    intensity.push_back(static_cast<float>(one == 1 ? value : value / one));
  }
  return intensity;
}

std::vector<std::uint16_t> ReadRing(const pcd::Table& table, const std::string& where) {
  std::vector<std::uint16_t> ring;
  for (const double value : table.Column("ring")) {
    if (!(value >= 0 && value <= 65535)) {
      throw InputError(where + ": ring holds " + std::to_string(value) + "; expected 0 to 65535");
    }
    ring.push_back(static_cast<std::uint16_t>(value));
  }
  return ring;
}

Utime ToUtime(double microseconds, const std::string& where, const std::string& field) {
  if (!(std::abs(microseconds) < 9e18)) {  // NaN as well
    throw InputError(where + ": " + field + " holds " + std::to_string(microseconds) +
                     " us; expected a time");
  }
  return static_cast<Utime>(std::llround(microseconds));
}

std::vector<Utime> ReadUtime(const pcd::Table& table, Utime sweep_utime, const std::string& where) {
  std::vector<Utime> utime;
  if (table.Has("utime")) {
    for (const double value : table.Column("utime")) {
      utime.push_back(ToUtime(value, where, "utime"));
    }
    return utime;
  }
  for (const char* field : {"timestamp", "time", "t"}) {
    if (!table.Has(field)) continue;
    // Drivers that count in integers (Ouster's "t") count nanoseconds.
    const double seconds_per_unit = table.TypeOf(field) == 'F' ? 1 : 1e-9;
    for (const double value : table.Column(field)) {
      const double seconds = value * seconds_per_unit;
      const Utime from = std::abs(seconds) < kAbsoluteSeconds ? sweep_utime : 0;
      utime.push_back(from + ToUtime(seconds * 1e6, where, field));
    }
    return utime;
  }
  return utime;
}

// By the fields line and beam, if every point stands where they say.
bool OrganiseByFields(const pcd::Table& table, Cloud* cloud) {
  if (!table.Has("line") || !table.Has("beam")) return false;
  const std::vector<double> line = table.Column("line"), beam = table.Column("beam");
  const double first = line.front();
  const double lines = line.back() - first + 1, beams = beam.back() + 1;
  if (!(first >= 0 && first < 1e9 && lines >= 1 && beams >= 1) ||
      lines * beams != static_cast<double>(line.size())) {
    return false;
  }
  const std::size_t width = static_cast<std::size_t>(beams);
  for (std::size_t i = 0; i < line.size(); ++i) {
    const std::size_t row = i / width;
    const bool in_place = line[i] == first + static_cast<double>(row) &&
                          beam[i] == static_cast<double>(i - row * width);
    if (!in_place) return false;
  }
  cloud->first_line = static_cast<int>(first);
  cloud->lines = static_cast<int>(lines);
  cloud->beams = static_cast<int>(beams);
  return true;
}

void Organise(const pcd::Table& table, Cloud* cloud) {
  cloud->organised = true;
  if (OrganiseByFields(table, cloud)) return;
  cloud->lines = static_cast<int>(table.header().height);
  cloud->beams = static_cast<int>(table.header().width);
  cloud->organised = cloud->lines > 1;
}

// One a line: that of its first beam.
std::vector<Eigen::Vector3f> ReadOrigins(const pcd::Table& table, const Cloud& cloud) {
  const std::vector<Eigen::Vector3f> all = ReadVectors(table, "origin_x", "origin_y", "origin_z");
  std::vector<Eigen::Vector3f> origins;
  origins.reserve(static_cast<std::size_t>(cloud.lines));
  for (int line = 0; line < cloud.lines; ++line) {
    origins.push_back(all[static_cast<std::size_t>(line) * static_cast<std::size_t>(cloud.beams)]);
  }
  return origins;
}

bool HasVector(const pcd::Table& table, const std::string& prefix) {
  return table.Has(prefix + "x") && table.Has(prefix + "y") && table.Has(prefix + "z");
}

}  // namespace

Cloud ReadPcd(const std::filesystem::path& path, Utime sweep_utime) {
  return ParsePcd(ReadWholeFile(path), path.string(), sweep_utime);
}

Cloud ParsePcd(const std::string& bytes, const std::string& where, Utime sweep_utime) {
  const pcd::Table table(bytes, where);
  Cloud cloud;
  cloud.sweep_utime = sweep_utime;
  cloud.points = ReadVectors(table, "x", "y", "z");
  MarkMisses(&cloud.points, where);
  Organise(table, &cloud);
  if (HasVector(table, "dir_")) cloud.directions = ReadVectors(table, "dir_x", "dir_y", "dir_z");
  if (HasVector(table, "origin_")) cloud.origins = ReadOrigins(table, cloud);
  if (table.Has("intensity")) cloud.intensity = ReadIntensity(table);
  if (table.Has("ring")) cloud.ring = ReadRing(table, where);
  cloud.utime = ReadUtime(table, sweep_utime, where);
  return cloud;
}

}  // namespace rgbdt
