#include "calib/methods/natural/shot_places.h"

#include "calib/odometry/odometry.h"

namespace rgbdt {

void FindPlaces(std::vector<Shot>* shots) {
  std::vector<const Cloud*> sweeps;
  sweeps.reserve(shots->size());
  for (const Shot& shot : *shots) sweeps.push_back(shot.cloud);
  const std::vector<StopPlace> places = Odometry::FindStops(sweeps);
  for (std::size_t i = 0; i < shots->size(); ++i) {
    (*shots)[i].place = {places[i].world, places[i].world_from_lidar};
  }
}

}  // namespace rgbdt
