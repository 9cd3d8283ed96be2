#include "calib/simulate/internal/hidden_outline.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "calib/simulate/internal/shading.h"

namespace rgbdt::simulate {
namespace {

/// A place on the outline, target frame.
struct Station {
  Eigen::Vector2d place, along, outwards;
};

std::vector<Station> Stations(const BoardOptions& options) {
  std::vector<Station> stations;
  const Eigen::Vector2d half(0.5 * options.width_m, 0.5 * options.height_m);
  for (const double side : {-1.0, 1.0}) {
    for (const double u : {-0.6, -0.3, 0.0, 0.3, 0.6}) {
      stations.push_back({{u * half.x(), side * half.y()}, {1, 0}, {0, side}});
      stations.push_back({{side * half.x(), u * half.y()}, {0, 1}, {side, 0}});
    }
  }
  return stations;
}

/// Mean apparent temperature behind a stretch of the outline; nothing if that is sky or stand, or
/// varies by more than 1 K.
std::optional<double> BackgroundAt(const World& world, const Eigen::Vector3d& camera_centre,
                                   const Station& station, double length_m) {
  double low = std::numeric_limits<double>::infinity();
  double high = 0;
  double sum = 0;
  constexpr int kRays = 5;
  for (int i = 0; i < kRays; ++i) {
    const double along = (i / (kRays - 1.0) - 0.5) * length_m;
    const Eigen::Vector2d place = station.place + along * station.along + 0.03 * station.outwards;
    const Eigen::Vector3d target =
        world.board()->lidar_from_target() * Eigen::Vector3d(place.x(), place.y(), 0);
    const Eigen::Vector3d direction = (target - camera_centre).normalized();
    const Hit hit = world.caster().Cast(camera_centre, direction);
    if (!hit.hit() || world.IsMoving(hit)) return std::nullopt;
    const double apparent = SeeHeat(world, camera_centre, direction, 0.01).value[0];
    low = std::min(low, apparent);
    high = std::max(high, apparent);
    sum += apparent;
  }
  if (high - low > 1) return std::nullopt;
  return sum / kRays;
}

}  // namespace

HeatMap HideOutline(const World& world, const Eigen::Vector3d& camera_centre,
                    const BoardOptions& options) {
  HeatMap heat = world.board()->heat();
  if (options.hidden_outline_m == 0) return heat;
  const HeatMap before = heat;
  double least = std::numeric_limits<double>::infinity();
  for (const Station& station : Stations(options)) {
    const std::optional<double> apparent =
        BackgroundAt(world, camera_centre, station, options.hidden_outline_m);
    if (!apparent) continue;
    const double behind =
        SurfaceTemperature(*apparent, options.emissivity, world.scene().reflected_temperature_k);
    const double contrast = std::abs(before.BorderAt(station.place) - behind);
    if (contrast >= least) continue;
    least = contrast;
    heat.hides = true;
    heat.hidden_centre = station.place;
    heat.hidden_along = station.along;
    heat.hidden_half_m = 0.5 * options.hidden_outline_m;
    heat.hidden_depth_m = options.hidden_depth_m;
    heat.hidden_k = behind;
  }
  return heat;
}

}  // namespace rgbdt::simulate
