#pragma once

#include <vector>

#include "calib/model/cloud.h"
#include "calib/model/rig.h"

namespace rgbdt {

/// One line in 3D: point_in_lidar = Rz(angle) * motor_from_scanner * (r cos a, 0, r sin a), with
/// the motor's angle of each beam (the motor turns while a line is fired). `angles` [rad] is as
/// long as the line. Misses keep their direction.
Cloud LineToCloud(const TurnedScanner& scanner, const LineScan& line,
                  const std::vector<double>& angles);

}  // namespace rgbdt
