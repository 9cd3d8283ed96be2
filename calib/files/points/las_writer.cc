#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>
#include <limits>
#include <string_view>

#include "calib/files/atomic_file.h"
#include "calib/files/points/internal/fused_comments.h"
#include "calib/files/points/internal/las_layout.h"
#include "calib/files/points/internal/laz_file.h"
#include "calib/files/points/internal/records.h"
#include "calib/files/points/las_files.h"
#include "calib/model/errors.h"

namespace rgbdt {
namespace {

using las::ExtraDimension;
using records::Column;
using records::MakeColumn;
using Points = std::vector<Eigen::Vector3f>;
using Colours = std::vector<std::array<std::uint8_t, 3>>;

constexpr const char* kNoSystem =
    "Coordinates in metres, no coordinate reference system. Extra dimension temperature in kelvin, "
    "NaN: unknown.\n";

void RequireLengths(const std::filesystem::path& path, std::size_t points,
                    std::initializer_list<std::size_t> lengths) {
  if (points == 0) throw InputError("cannot write " + path.string() + ": there are no points");
  for (const std::size_t length : lengths) {
    if (length == points) continue;
    throw InputError("cannot write " + path.string() + ": there are " + std::to_string(points) +
                     " points but " + std::to_string(length) + " values of another kind");
  }
}

// In steps, rounded; RequireInside has seen that it fits.
std::int32_t Steps(float metres) {
  return static_cast<std::int32_t>(std::lround(static_cast<double>(metres) / kLasStepM));
}

void RequireInside(const std::filesystem::path& path, const Points& points) {
  constexpr double most_m = kLasStepM * (std::numeric_limits<std::int32_t>::max() - 1);
  for (const Eigen::Vector3f& point : points) {
    if (point.allFinite() && point.cwiseAbs().maxCoeff() < most_m) continue;
    throw InputError("cannot write " + path.string() + ": it has a point at " +
                     std::to_string(point.x()) + ", " + std::to_string(point.y()) + ", " +
                     std::to_string(point.z()) + " m; LAS holds " + std::to_string(most_m) +
                     " m in steps of 0.1 mm");
  }
}

std::uint16_t Intensity16(float intensity) {
  if (!(intensity > 0)) return 0;  // nor NaN
  return static_cast<std::uint16_t>(std::lround(std::min(intensity, 1.0F) * 65535.0F));
}

// The fields of point record format 7, in its order.
std::vector<Column> Columns(const Points& points, const std::vector<float>* intensity,
                            const std::vector<Utime>& utime, const Colours& rgb) {
  std::vector<Column> columns;
  columns.reserve(15);  // with extra dimensions
  for (int axis = 0; axis < 3; ++axis) {
    columns.push_back(MakeColumn<std::int32_t>(
        "xyz", [&points, axis](std::size_t i) { return Steps(points[i][axis]); }));
  }
  columns.push_back(MakeColumn<std::uint16_t>("intensity", [intensity](std::size_t i) {
    return intensity == nullptr ? 0 : Intensity16((*intensity)[i]);
  }));
  columns.push_back(MakeColumn<std::uint8_t>("return 1 of 1", [](std::size_t) { return 0x11; }));
  // Flags, class, user's byte, scan angle (2), source (2).
  columns.push_back(MakeColumn<std::uint8_t>("flags", [](std::size_t) { return 0; }));
  columns.push_back(MakeColumn<std::uint16_t>("class and user", [](std::size_t) { return 0; }));
  columns.push_back(MakeColumn<std::uint32_t>("angle and source", [](std::size_t) { return 0; }));
  columns.push_back(
      MakeColumn<double>("gps_time", [&utime](std::size_t i) { return las::GpsTime(utime[i]); }));
  for (std::size_t c = 0; c < 3; ++c) {
    columns.push_back(MakeColumn<std::uint16_t>(
        "rgb", [&rgb, c](std::size_t i) { return 257 * rgb[i][c]; }));  // 255 becomes 65535
  }
  return columns;
}

// Extra dimensions of four bytes, as the records have them.
template <typename T>
void Add(const std::vector<T>& values, const std::string& name, const std::string& description,
         std::vector<Column>* columns, las::Layout* layout) {
  static_assert(sizeof(T) == 4);
  columns->push_back(MakeColumn<T>(name, [&values](std::size_t i) { return values[i]; }));
  layout->extra.push_back(
      {name, description,
       std::is_floating_point_v<T> ? ExtraDimension::Type::kFloat : ExtraDimension::Type::kUint32});
}

// A file's bytes, in pieces.
laz::Parts PartsOf(LasKind kind, const las::Layout& layout, std::string records) {
  if (kind == LasKind::kLaz) return laz::LazFile(layout, records);
  if (kind == LasKind::kCopc) return laz::CopcFile(layout, records);
  laz::Parts parts = {las::Head(layout)};
  parts.push_back(std::move(records));
  return parts;
}

void Write(const std::filesystem::path& path, const Points& points,
           const std::vector<Column>& columns, las::Layout layout) {
  layout.points = points.size();
  layout.step_m = kLasStepM;
  layout.least.setConstant(std::numeric_limits<double>::infinity());
  layout.most = -layout.least;
  for (const Eigen::Vector3f& point : points) {
    const Eigen::Array3d written =
        Eigen::Array3d(Steps(point.x()), Steps(point.y()), Steps(point.z())) * kLasStepM;
    layout.least = layout.least.min(written);
    layout.most = layout.most.max(written);
  }
  const LasKind kind = LasKindOf(path).value_or(LasKind::kPlain);
  const laz::Parts parts = PartsOf(kind, layout, records::Pack(columns, points.size()));
  AtomicFile file(path);
  for (const std::string& part : parts) file.Write(part);
  file.Commit();
}

}  // namespace

std::optional<LasKind> LasKindOf(const std::filesystem::path& path) {
  std::string name = path.filename().string();
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const auto ends = [&name](std::string_view ending) {
    return name.size() > ending.size() &&
           name.compare(name.size() - ending.size(), ending.size(), ending) == 0;
  };
  if (ends(".copc.laz")) return LasKind::kCopc;
  if (ends(".laz")) return LasKind::kLaz;
  if (ends(".las")) return LasKind::kPlain;
  return std::nullopt;
}

void WriteLas(const std::filesystem::path& path, const RgbdtCloud& cloud) {
  RequireLengths(
      path, cloud.size(),
      {cloud.intensity.size(), cloud.utime.size(), cloud.rgb.size(), cloud.temperature_k.size(),
       cloud.temperature_sigma_k.size(), cloud.valid.size()});
  RequireInside(path, cloud.points);
  las::Layout layout;
  layout.text = kNoSystem;
  for (const std::string& comment : FusedComments(cloud)) layout.text += comment + "\n";
  std::vector<Column> columns = Columns(cloud.points, &cloud.intensity, cloud.utime, cloud.rgb);
  Add(cloud.temperature_k, "temperature", "[K]; NaN: unknown", &columns, &layout);
  Add(cloud.temperature_sigma_k, "temperature_sigma", "1 sigma [K]; NaN: unknown", &columns,
      &layout);
  Add(cloud.valid, "valid", "bit i: seen by camera i", &columns, &layout);
  Write(path, cloud.points, columns, std::move(layout));
}

void WriteLas(const std::filesystem::path& path, const MapCloud& map) {
  RequireLengths(
      path, map.size(),
      {map.rgb.size(), map.temperature_k.size(), map.count.size(), map.last_seen.size()});
  RequireInside(path, map.points);
  las::Layout layout;
  layout.text = std::string(kNoSystem) + "frame: " + map.frame + "\n";
  std::vector<Column> columns = Columns(map.points, nullptr, map.last_seen, map.rgb);
  Add(map.temperature_k, "temperature", "[K]; NaN: unknown", &columns, &layout);
  Add(map.count, "count", "points in the voxel", &columns, &layout);
  Write(path, map.points, columns, std::move(layout));
}

}  // namespace rgbdt
