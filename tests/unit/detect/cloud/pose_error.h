#pragma once

#include <cmath>

#include "calib/model/rigid3.h"
#include "calib/model/view_detection.h"

namespace rgbdt {

/// delta of a found pose against the truth, up to half a turn; LIDAR axes.
inline Vector6d ErrorOf(const CloudEdges& found, const Rigid3& truth) {
  const Rigid3& pose = found.pose->sensor_from_target;
  const Rigid3 turned = truth * RotationAbout({0, 0, 1}, M_PI);
  const bool half = RotationDistance(pose, turned) < RotationDistance(pose, truth);
  return Log((half ? turned : truth) * pose.Inverse());
}

}  // namespace rgbdt
