#include <cmath>
#include <limits>

#include "services/messages/check.h"
#include "services/messages/internal/codec_types.h"
#include "services/messages/internal/fields.h"

namespace rgbdt {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

// A ring is an int16 on the wire, -1 for unknown: 65535 as uint16, by conversion both ways.

using Floats = std::vector<float>;

void Split(const std::vector<Eigen::Vector3f>& points, Floats* x, Floats* y, Floats* z) {
  x->resize(points.size());
  y->resize(points.size());
  z->resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    (*x)[i] = points[i].x();
    (*y)[i] = points[i].y();
    (*z)[i] = points[i].z();
  }
}

std::vector<Eigen::Vector3f> Join(const Floats& x, const Floats& y, const Floats& z) {
  std::vector<Eigen::Vector3f> points(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) points[i] = {x[i], y[i], z[i]};
  return points;
}

void CheckLengths(const Cloud& cloud) {
  const std::size_t size = cloud.size();
  CheckRange("lines", cloud.lines, 0, kMaxLines);
  CheckRange("beams", cloud.beams, 0, kMaxLines);
  CheckLength("points", size, static_cast<std::size_t>(cloud.lines) * cloud.beams, false);
  CheckLength("directions", cloud.directions.size(), size);
  CheckLength("origins", cloud.origins.size(), static_cast<std::size_t>(cloud.lines));
  CheckLength("intensity", cloud.intensity.size(), size);
  CheckLength("utime", cloud.utime.size(), size);
  CheckLength("ring", cloud.ring.size(), size);
}

void MissesToWire(const Cloud& cloud, cloud_t* wire) {
  for (std::size_t i = 0; i < cloud.directions.size(); ++i) {
    const Eigen::Vector3f& d = cloud.directions[i];
    if (cloud.IsHit(i) || std::isnan(d.x())) continue;
    wire->miss_index.push_back(static_cast<std::int32_t>(i));
    wire->miss_x.push_back(d.x());
    wire->miss_y.push_back(d.y());
    wire->miss_z.push_back(d.z());
  }
  wire->num_misses = CountOf(wire->miss_index.size(), "num_misses");
}

void TimesToWire(const Cloud& cloud, cloud_t* wire) {
  wire->utime = cloud.utime.empty() ? cloud.sweep_utime : cloud.utime.front();
  CheckUtime("utime", wire->utime);
  wire->utime_offset_us.resize(cloud.size(), 0);
  for (std::size_t i = 0; i < cloud.utime.size(); ++i) {
    CheckUtime("utime", cloud.utime[i]);
    const std::int64_t offset = cloud.utime[i] - wire->utime;
    CheckRange("utime_offset_us", offset, std::numeric_limits<std::int32_t>::min(),
               std::numeric_limits<std::int32_t>::max());
    wire->utime_offset_us[i] = static_cast<std::int32_t>(offset);
  }
}

void CheckShape(const cloud_t& wire) {
  CheckRange("first_line", wire.first_line, 0, kMaxLines);
  CheckRange("num_lines", wire.num_lines, 0, wire.organised ? kMaxLines : 1);
  CheckRange("num_beams", wire.num_beams, wire.num_lines > 0 ? 1 : 0, kMaxLines);
  const std::int64_t points = std::int64_t{wire.num_lines} * wire.num_beams;
  CheckRange("num_points", wire.num_points, points, points);
  if (wire.num_origins != 0) {
    CheckRange("num_origins", wire.num_origins, wire.num_lines, wire.num_lines);
  }
  CheckRange("sweep_lines", wire.sweep_lines, 0, kMaxLines);
  CheckRange("lines_lost", wire.lines_lost, 0, kMaxLines);
}

bool Within(float v) { return std::abs(v) <= kMaxMetres; }  // not so for NaN

[[noreturn]] void FailPoint(const cloud_t& wire, std::size_t i) {
  Fail(At("point", i),
       "(" + std::to_string(wire.x_m[i]) + ", " + std::to_string(wire.y_m[i]) + ", " +
           std::to_string(wire.z_m[i]) + ") m",
       "finite numbers up to 1e6 and not the beam's origin, or NaN in all three where nothing "
       "returned");
}

void CheckOrigins(const cloud_t& wire) {
  for (std::size_t i = 0; i < wire.origin_x_m.size(); ++i) {
    if (!Within(wire.origin_x_m[i]) || !Within(wire.origin_y_m[i]) || !Within(wire.origin_z_m[i])) {
      Fail(At("origin", i), wire.origin_x_m[i], "finite numbers up to 1e6 m");
    }
  }
}

// Drivers that mean "nothing returned" write a hit in the origin: nearer than this is one [m^2].
constexpr float kMinSquaredRange = 1e-12F;

void CheckPoints(const cloud_t& wire) {
  const bool has_origins = wire.num_origins > 0;
  std::size_t i = 0;
  for (std::size_t line = 0; line < static_cast<std::size_t>(wire.num_lines); ++line) {
    const float ox = has_origins ? wire.origin_x_m[line] : 0;
    const float oy = has_origins ? wire.origin_y_m[line] : 0;
    const float oz = has_origins ? wire.origin_z_m[line] : 0;
    for (std::int32_t beam = 0; beam < wire.num_beams; ++beam, ++i) {
      const float x = wire.x_m[i];
      const float y = wire.y_m[i];
      const float z = wire.z_m[i];
      const float squared = (x - ox) * (x - ox) + (y - oy) * (y - oy) + (z - oz) * (z - oz);
      const bool hit = Within(x) && Within(y) && Within(z) && squared > kMinSquaredRange;
      if (!hit && !(std::isnan(x) && std::isnan(y) && std::isnan(z))) FailPoint(wire, i);
    }
  }
}

void CheckAttributes(const cloud_t& wire) {
  for (std::size_t i = 0; i < wire.intensity.size(); ++i) {
    const float intensity = wire.intensity[i];
    if (!std::isnan(intensity) && !(intensity >= 0 && intensity <= 1)) {
      Fail(At("intensity", i), intensity, "0 to 1, or NaN: unknown");
    }
    if (wire.ring[i] < -1) Fail(At("ring", i), wire.ring[i], "0 to 32767, or -1: unknown");
    if (wire.utime + wire.utime_offset_us[i] <= 0) {
      Fail(At("utime_offset_us", i), wire.utime_offset_us[i], "a time after 1970");
    }
  }
}

void CheckMisses(const cloud_t& wire) {
  std::int64_t previous = -1;
  for (std::size_t i = 0; i < wire.miss_index.size(); ++i) {
    const std::int32_t index = wire.miss_index[i];
    if (index <= previous || index >= wire.num_points) {
      Fail(At("miss_index", i), index,
           "ascending numbers below " + std::to_string(wire.num_points));
    }
    previous = index;
    if (!std::isnan(wire.x_m[static_cast<std::size_t>(index)])) {
      Fail(At("miss_index", i), index, "a beam that returned nothing");
    }
    CheckUnitVector("miss", Eigen::Vector3d(wire.miss_x[i], wire.miss_y[i], wire.miss_z[i]));
  }
}

// Of misses only; a hit's direction follows from its point (DirectionOf).
std::vector<Eigen::Vector3f> Directions(const cloud_t& wire, std::size_t size) {
  std::vector<Eigen::Vector3f> directions(size, Eigen::Vector3f::Constant(kNan));
  for (std::size_t i = 0; i < wire.miss_index.size(); ++i) {
    directions[static_cast<std::size_t>(wire.miss_index[i])] = {wire.miss_x[i], wire.miss_y[i],
                                                                wire.miss_z[i]};
  }
  return directions;
}

}  // namespace

// All but the arrays.
template <typename Copy>
void Fields(const Copy& copy, WireOf<Copy, cloud_t>& wire, StructOf<Copy, CloudChunk>& chunk) {
  auto& cloud = chunk.cloud;
  copy(wire.seq, chunk.seq);
  copy(wire.sweep_utime, cloud.sweep_utime);
  copy(wire.organised, cloud.organised);
  copy(wire.first_line, cloud.first_line);
  copy(wire.num_lines, cloud.lines);
  copy(wire.num_beams, cloud.beams);
  copy(wire.sweep_end, chunk.sweep_end);
  copy(wire.sweep_lines, chunk.sweep_lines);
  copy(wire.lines_lost, chunk.lines_lost);
}

cloud_t ToWire(const CloudChunk& chunk) {
  const Cloud& cloud = chunk.cloud;
  CheckLengths(cloud);
  auto wire = FieldsToWire<cloud_t>(chunk);
  wire.num_points = CountOf(cloud.size(), "num_points");
  wire.num_origins = CountOf(cloud.origins.size(), "num_origins");
  Split(cloud.points, &wire.x_m, &wire.y_m, &wire.z_m);
  Split(cloud.origins, &wire.origin_x_m, &wire.origin_y_m, &wire.origin_z_m);
  wire.intensity = cloud.intensity;
  wire.intensity.resize(cloud.size(), kNan);
  wire.ring.assign(cloud.ring.begin(), cloud.ring.end());
  wire.ring.resize(cloud.size(), -1);
  TimesToWire(cloud, &wire);
  MissesToWire(cloud, &wire);
  return wire;
}

void Check(const cloud_t& wire) {
  CheckUtime("utime", wire.utime);
  CheckUtime("sweep_utime", wire.sweep_utime);
  CheckShape(wire);
  CheckOrigins(wire);
  CheckPoints(wire);
  CheckAttributes(wire);
  CheckMisses(wire);
}

CloudChunk FromWire(const cloud_t& wire) {
  auto chunk = FieldsFromWire<CloudChunk>(wire);
  Cloud& cloud = chunk.cloud;
  cloud.points = Join(wire.x_m, wire.y_m, wire.z_m);
  cloud.origins = Join(wire.origin_x_m, wire.origin_y_m, wire.origin_z_m);
  cloud.directions = Directions(wire, cloud.size());
  cloud.intensity = wire.intensity;
  cloud.ring.assign(wire.ring.begin(), wire.ring.end());
  cloud.utime.resize(wire.utime_offset_us.size());
  for (std::size_t i = 0; i < cloud.utime.size(); ++i) {
    cloud.utime[i] = wire.utime + wire.utime_offset_us[i];
  }
  return chunk;
}

}  // namespace rgbdt
