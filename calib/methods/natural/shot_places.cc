#include "calib/methods/natural/shot_places.h"

#include "calib/odometry/odometry.h"

namespace rgbdt {

std::vector<ShotPlace> FindPlaces(const std::vector<const Cloud*>& sweeps) {
  std::vector<ShotPlace> places;
  for (const StopPlace& stop : Odometry::FindStops(sweeps)) {
    places.push_back({stop.world, stop.world_from_lidar});
  }
  return places;
}

}  // namespace rgbdt
