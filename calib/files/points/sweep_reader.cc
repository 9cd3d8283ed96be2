#include <algorithm>
#include <cmath>
#include <limits>

#include "calib/files/atomic_file.h"
#include "calib/files/points/cloud_files.h"
#include "calib/files/points/internal/pcd_table.h"
#include "calib/files/points/internal/ply_table.h"
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

// Rows of the header; 1: it knows none.
void Organise(const records::Table& table, std::size_t rows, Cloud* cloud) {
  cloud->organised = true;
  if (OrganiseByFields(table, cloud)) return;
  if (rows > 1 && OrganiseByRings(cloud)) return;
  cloud->lines = static_cast<int>(rows);
  cloud->beams = static_cast<int>(table.size() / rows);
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

Cloud FromTable(const records::Table& table, std::size_t rows, const std::string& where,
                Utime sweep_utime) {
  Cloud cloud;
  cloud.sweep_utime = sweep_utime;
  cloud.points = ReadVectors(table, "x", "y", "z");
  MarkMisses(&cloud.points, where);
  if (table.Has("ring")) cloud.ring = ReadRing(table, cloud.points, where);
  Organise(table, rows, &cloud);
  if (HasVector(table, "dir_")) cloud.directions = ReadVectors(table, "dir_x", "dir_y", "dir_z");
  if (HasVector(table, "origin_")) cloud.origins = ReadOrigins(table, cloud);
  if (table.Has("intensity")) cloud.intensity = ReadIntensity(table);
  cloud.utime = ReadUtime(table, sweep_utime, where);
  return cloud;
}

bool EndsWith(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

// Floats without a head, as data sets have them: KITTI's x y z intensity, nuScenes' with the ring.
Cloud ReadBare(const std::string& name, Utime sweep_utime) {
  records::Source source;
  source.where = name;
  for (const char* field : {"x", "y", "z", "intensity"}) source.fields.push_back({field});
  if (EndsWith(name, ".pcd.bin")) source.fields.push_back({"ring"});
  const std::size_t record = source.RecordBytes();
  const std::string bytes = ReadWholeFile(name, kMostSweepPoints * record);
  if (bytes.empty() || bytes.size() % record != 0) {
    throw InputError(name + ": is " + std::to_string(bytes.size()) + " bytes; expected points of " +
                     std::to_string(record) + ": x y z intensity" +
                     (source.fields.size() > 4 ? " ring" : "") + ", each a float of 4 bytes");
  }
  source.bytes = bytes;
  source.data_begin = 0;
  source.count = bytes.size() / record;
  const records::Table table = records::Table::FromBinary(std::move(source));
  for (const double intensity : table.Column("intensity")) {
    if (intensity >= 0 && intensity <= 65535) continue;
    throw InputError(name + ": its fourth numbers are no intensities (" +
                     std::to_string(intensity) + "), so its points are not x y z intensity; " +
                     "write it as PCD or PLY, whose fields have names");
  }
  return FromTable(table, 1, name, sweep_utime);
}

}  // namespace

Cloud ReadSweep(const std::filesystem::path& path, Utime sweep_utime) {
  constexpr std::size_t kHeadBytes = 64 * 1024;
  if (EndsWith(path.string(), ".bin")) return ReadBare(path.string(), sweep_utime);
  const std::string head = ReadFileHead(path, kHeadBytes);
  if (head.compare(0, 3, "ply") != 0) {
    pcd::CheckSweepHead(head, path.string());
    return ParsePcd(ReadWholeFile(path, kMostPointsBytes), path.string(), sweep_utime);
  }
  ply::CheckSweepHead(head, path.string());
  const std::string bytes = ReadWholeFile(path, kMostPointsBytes);
  return FromTable(ply::Parse(bytes, path.string()).table, 1, path.string(), sweep_utime);
}

Cloud ParsePcd(const std::string& bytes, const std::string& where, Utime sweep_utime) {
  const pcd::File file = pcd::Parse(bytes, where);
  return FromTable(file.table, file.header.height, where, sweep_utime);
}

}  // namespace rgbdt
