#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "calib/model/cloud.h"
#include "calib/model/rig.h"

namespace rgbdt {

/// The hits of one sweep as the sensors measured them, before any geometry:
/// point_in_lidar = Rz(motor) * motor_from_scanner * (r cos a, 0, r sin a).
struct TurnedBeams {
  std::vector<double> motor_rad;  ///< the motor's angle when the beam was fired
  std::vector<double> scan_rad;   ///< a: in the scan plane, from the scanner's x towards its z
  std::vector<double> range_m;    ///< r

  std::size_t size() const { return range_m.size(); }
};

/// Adds a line's hits. `angles` [rad]: the motor's, one a beam, as BeamAngles gives them.
void AppendLine(const LineScan& line, const std::vector<double>& angles, TurnedBeams* beams);

/// Which half of the scan line a beam belongs to: fired away from where the motor points.
bool IsBehind(const TurnedScanner& scanner, double scan_rad);

/// What the beams become, LIDAR frame [m].
std::vector<Eigen::Vector3d> PointsOf(const TurnedScanner& scanner, const TurnedBeams& beams);

/// Takes an assembled cloud apart: `scanner` is the geometry that it was assembled with. A point
/// p that turns into the scan plane at the motor's angle t has m . (Rz(-t) p - lever) = 0, with m
/// the plane's normal; this has two solutions, about half a turn apart: the point before the
/// motor's axis or behind it. Which, is a matter of the beam's number alone, and of the two ways to
/// number them the one is taken that agrees with the cloud's origins, else the one by which the
/// motor turns evenly during a line. Where lever arm and tilt are so small that both do, beams are
/// taken to be numbered by rising scan angle. Hits within 0.1 m of the axis say nothing and are
/// left out. Throws InputError for a cloud that is not line x beam, or not of this geometry.
TurnedBeams BeamsOfCloud(const TurnedScanner& scanner, const Cloud& cloud);

}  // namespace rgbdt
