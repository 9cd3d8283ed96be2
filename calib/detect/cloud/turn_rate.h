#pragma once

#include <Eigen/Core>

#include "calib/model/cloud.h"

namespace rgbdt {

/// How fast a turned scanner's motor turned about the LIDAR's z [rad/s] while it scanned what lies
/// about `towards` (LIDAR frame): the median, over the lines about there, of how far each beam's
/// azimuth came from one line to the next, over their times. 0: fewer than two lines tell it, or
/// the cloud is not line x beam or has no times.
double TurnRate(const Cloud& cloud, const Eigen::Vector3d& towards);

}  // namespace rgbdt
