#include <algorithm>
#include <cmath>
#include <limits>

#include "calib/files/atomic_file.h"
#include "calib/files/points/cloud_files.h"
#include "calib/files/points/internal/pcd_table.h"
#include "calib/files/points/internal/point_columns.h"
#include "calib/model/errors.h"

namespace rgbdt {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

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

// A miss may have none.
std::vector<std::uint16_t> ReadRing(const records::Table& table,
                                    const std::vector<Eigen::Vector3f>& points,
                                    const std::string& where) {
  std::vector<std::uint16_t> ring;
  for (const double value : table.Column("ring")) {
    const bool missed = std::isnan(value) && !points[ring.size()].allFinite();
    if (!missed && !(value >= 0 && value <= 65535)) {
      throw InputError(where + ": ring holds " + std::to_string(value) + "; expected 0 to 65535");
    }
    ring.push_back(missed ? 0 : static_cast<std::uint16_t>(value));
  }
  return ring;
}

// By the fields line and beam, if every point stands where they say.
bool OrganiseByFields(const records::Table& table, Cloud* cloud) {
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

// Columns one behind the other, each with all rings, whatever the header says of rows: so some
// drivers of Ouster's write them.
bool OrganiseByRings(Cloud* cloud) {
  const std::vector<std::uint16_t>& ring = cloud->ring;
  if (ring.empty()) return false;
  const std::size_t rings = std::size_t{1} + *std::max_element(ring.begin(), ring.end());
  if (rings < 2 || ring.size() % rings != 0 || ring.size() < 2 * rings) return false;
  std::vector<bool> seen(rings, false);
  for (std::size_t i = 0; i < rings; ++i) seen[ring[i]] = true;
  if (std::find(seen.begin(), seen.end(), false) != seen.end()) return false;
  for (std::size_t i = rings; i < ring.size(); ++i) {
    if (ring[i] != ring[i - rings]) return false;
  }
  cloud->lines = static_cast<int>(ring.size() / rings);
  cloud->beams = static_cast<int>(rings);
  return true;
}

void Organise(const pcd::File& file, Cloud* cloud) {
  cloud->organised = true;
  if (OrganiseByFields(file.table, cloud)) return;
  if (file.header.height > 1 && OrganiseByRings(cloud)) return;
  cloud->lines = static_cast<int>(file.header.height);
  cloud->beams = static_cast<int>(file.header.width);
  cloud->organised = cloud->lines > 1;
}

// One a line: that of its first beam.
std::vector<Eigen::Vector3f> ReadOrigins(const records::Table& table, const Cloud& cloud) {
  const std::vector<Eigen::Vector3f> all = ReadVectors(table, "origin_x", "origin_y", "origin_z");
  std::vector<Eigen::Vector3f> origins;
  origins.reserve(static_cast<std::size_t>(cloud.lines));
  for (int line = 0; line < cloud.lines; ++line) {
    origins.push_back(all[static_cast<std::size_t>(line) * static_cast<std::size_t>(cloud.beams)]);
  }
  return origins;
}

bool HasVector(const records::Table& table, const std::string& prefix) {
  return table.Has(prefix + "x") && table.Has(prefix + "y") && table.Has(prefix + "z");
}

}  // namespace

Cloud ReadPcd(const std::filesystem::path& path, Utime sweep_utime) {
  constexpr std::size_t kHeadBytes = 64 * 1024;
  pcd::CheckSweepHead(ReadFileHead(path, kHeadBytes), path.string());
  return ParsePcd(ReadWholeFile(path, kMostPointsBytes), path.string(), sweep_utime);
}

Cloud ParsePcd(const std::string& bytes, const std::string& where, Utime sweep_utime) {
  const pcd::File file = pcd::Parse(bytes, where);
  const records::Table& table = file.table;
  Cloud cloud;
  cloud.sweep_utime = sweep_utime;
  cloud.points = ReadVectors(table, "x", "y", "z");
  MarkMisses(&cloud.points, where);
  if (table.Has("ring")) cloud.ring = ReadRing(table, cloud.points, where);
  Organise(file, &cloud);
  if (HasVector(table, "dir_")) cloud.directions = ReadVectors(table, "dir_x", "dir_y", "dir_z");
  if (HasVector(table, "origin_")) cloud.origins = ReadOrigins(table, cloud);
  if (table.Has("intensity")) cloud.intensity = ReadIntensity(table);
  cloud.utime = ReadUtime(table, sweep_utime, where);
  return cloud;
}

}  // namespace rgbdt
