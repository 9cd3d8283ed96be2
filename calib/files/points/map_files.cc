#include "calib/files/points/map_files.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <utility>

#include "calib/files/atomic_file.h"
#include "calib/files/points/cloud_files.h"
#include "calib/files/points/internal/ply_table.h"
#include "calib/files/points/internal/records.h"
#include "calib/model/errors.h"
#include "calib/model/text.h"

namespace rgbdt {
namespace {

using records::Column;
using records::MakeColumn;

const std::string kMapComment = "rgbdt map: voxels";

void CheckMap(const MapCloud& map, const std::filesystem::path& path) {
  const std::size_t n = map.size();
  if (n == 0) throw InputError("cannot write " + path.string() + ": the map is empty");
  for (const std::size_t have :
       {map.rgb.size(), map.temperature_k.size(), map.count.size(), map.last_seen.size()}) {
    if (have != n) {
      throw InputError("cannot write " + path.string() + ": the map has " + std::to_string(n) +
                       " points but " + std::to_string(have) + " values of another kind");
    }
  }
}

std::vector<Column> Columns(const MapCloud& map) {
  std::vector<Column> columns;
  columns.reserve(3 + 3 + 3);  // place, colour, and the rest one by one
  for (int axis = 0; axis < 3; ++axis) {
    columns.push_back(MakeColumn<float>(
        std::string(1, "xyz"[axis]), [&map, axis](std::size_t i) { return map.points[i][axis]; }));
  }
  const char* const names[] = {"red", "green", "blue"};
  for (std::size_t c = 0; c < 3; ++c) {
    columns.push_back(
        MakeColumn<std::uint8_t>(names[c], [&map, c](std::size_t i) { return map.rgb[i][c]; }));
  }
  columns.push_back(
      MakeColumn<float>("temperature_k", [&map](std::size_t i) { return map.temperature_k[i]; }));
  columns.push_back(
      MakeColumn<std::uint32_t>("count", [&map](std::size_t i) { return map.count[i]; }));
  columns.push_back(
      MakeColumn<double>("last_seen", [&map](std::size_t i) { return map.last_seen[i]; }));
  return columns;
}

std::string PlyType(const Column& column) {
  if (column.type == 'F') return column.size == 8 ? "double" : "float";
  return column.size == 1 ? "uchar" : "uint";
}

// One word, whatever the frame is called.
std::string Word(std::string text) {
  for (char& c : text) {
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  }
  return text.empty() ? "map" : text;
}

// A number as its type holds it; what does not fit becomes `otherwise`.
template <typename T>
T Fit(double value, T otherwise) {
  const bool fits = value >= static_cast<double>(std::numeric_limits<T>::lowest()) &&
                    value < static_cast<double>(std::numeric_limits<T>::max()) + 1;
  return fits ? static_cast<T>(value) : otherwise;
}

// The word after `key` in the comments.
std::optional<std::string> Comment(const ply::File& file, const std::string& key) {
  for (const std::string& comment : file.comments) {
    if (comment.rfind(key + ": ", 0) == 0) return comment.substr(key.size() + 2);
  }
  return std::nullopt;
}

bool IsMap(const ply::File& file) {
  return !file.comments.empty() && file.comments[0].rfind(kMapComment, 0) == 0;
}

void ReadComments(const ply::File& file, const std::string& where, MapCloud* map) {
  const std::string voxel = Comment(file, "voxel_m").value_or("");
  map->frame = Word(Comment(file, "frame").value_or("map"));
  const auto [end, error] =
      std::from_chars(voxel.data(), voxel.data() + voxel.size(), map->voxel_m);
  if (error != std::errc() || !(map->voxel_m > 0 && map->voxel_m < 1e6)) {
    throw InputError(where + ": its comment voxel_m is \"" + voxel.substr(0, 40) +
                     "\"; expected metres above 0");
  }
}

MapCloud FromFile(const ply::File& file, const std::string& where) {
  const auto column = [&](const char* name) { return file.table.Column(name); };
  const auto x = column("x"), y = column("y"), z = column("z");
  const auto red = column("red"), green = column("green"), blue = column("blue");
  const auto temperature = column("temperature_k");
  const auto count = column("count"), last_seen = column("last_seen");
  MapCloud map;
  for (std::size_t i = 0; i < file.table.size(); ++i) {
    const Eigen::Vector3f point = Eigen::Vector3d(x[i], y[i], z[i]).cast<float>();
    if (!point.allFinite()) continue;
    map.points.push_back(point);
    map.rgb.push_back({Fit<std::uint8_t>(red[i], 0), Fit<std::uint8_t>(green[i], 0),
                       Fit<std::uint8_t>(blue[i], 0)});
    map.temperature_k.push_back(static_cast<float>(temperature[i]));
    map.count.push_back(std::max(1U, Fit<std::uint32_t>(count[i], 1)));
    map.last_seen.push_back(Fit<Utime>(last_seen[i], 0));
  }
  if (map.points.empty()) throw InputError(where + ": none of its points is finite");
  ReadComments(file, where, &map);
  return map;
}

// Each point a voxel of its own.
MapCloud FromFused(RgbdtCloud cloud, const std::string& where) {
  if (cloud.points.empty()) throw InputError(where + ": none of its points is finite");
  MapCloud map;
  map.frame = "lidar";
  map.count.assign(cloud.size(), 1);
  map.points = std::move(cloud.points);
  map.rgb = std::move(cloud.rgb);
  map.temperature_k = std::move(cloud.temperature_k);
  map.last_seen = std::move(cloud.utime);
  return map;
}

}  // namespace

void WriteMapPly(const std::filesystem::path& path, const MapCloud& map) {
  CheckMap(map, path);
  const std::vector<Column> columns = Columns(map);
  std::string header = "ply\nformat binary_little_endian 1.0\ncomment " + kMapComment +
                       "; x y z [m] mean of the points in one; temperature_k [K], NaN: unknown; " +
                       "last_seen [us, UTC]\ncomment frame: " + Word(map.frame) +
                       "\ncomment voxel_m: " + Exact(map.voxel_m) + "\nelement vertex " +
                       std::to_string(map.size()) + "\n";
  for (const Column& column : columns) {
    header += "property " + PlyType(column) + " " + column.name + "\n";
  }
  WriteFileAtomically(path, header + "end_header\n" + records::Pack(columns, map.size()));
}

MapCloud ReadMapPly(const std::filesystem::path& path) {
  return ParseMapPly(ReadWholeFile(path, kMostPointsBytes), path.string());
}

MapCloud ParseMapPly(const std::string& bytes, const std::string& where) {
  const ply::File file = ply::Parse(bytes, where);
  if (!IsMap(file)) {
    throw InputError(where + ": is a PLY file but not a map; rgbdt map writes one");
  }
  return FromFile(file, where);
}

bool IsMapPly(const std::string& bytes) {
  const std::string head = bytes.substr(0, bytes.find("end_header"));
  return head.rfind("ply", 0) == 0 && head.find("\ncomment " + kMapComment) != std::string::npos;
}

MapCloud ReadMapOrCloud(const std::filesystem::path& path) {
  const std::string bytes = ReadWholeFile(path, kMostPointsBytes);
  const std::string where = path.string();
  if (bytes.rfind("ply", 0) == 0) {
    const ply::File file = ply::Parse(bytes, where);
    if (IsMap(file)) return FromFile(file, where);
  }
  return FromFused(ParseFused(bytes, where), where);
}

}  // namespace rgbdt
