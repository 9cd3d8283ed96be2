#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/model/pose_track.h"

namespace rgbdt {

/// Motion compensation: takes points [m] from the LIDAR frames of their own times to that of the
/// sweep. False: the poses do not tell of all of these times; the points are then as before.
bool PlaceInSweep(const PoseTrack& poses, const Rigid3& map_from_sweep,
                  const std::vector<Utime>& utime, std::vector<Eigen::Vector3f>* points);

}  // namespace rgbdt
