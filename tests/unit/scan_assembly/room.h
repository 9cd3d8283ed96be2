#pragma once

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <vector>

#include "calib/model/rigid3.h"
#include "calib/scan_assembly/turned_beams.h"
#include "tests/unit/matchers.h"

namespace rgbdt {

/// A flat surface: normal . p = offset, without end.
struct RoomPlane {
  Eigen::Vector3d normal;
  double offset = 0;
};

/// Walls that are not square to each other, a floor and a ceiling [m].
inline std::vector<RoomPlane> WholeRoom() {
  const auto wall = [](double azimuth, double offset) {
    return RoomPlane{{std::cos(azimuth), std::sin(azimuth), 0}, offset};
  };
  return {wall(0.1, 5), wall(1.7, 3.5),    wall(3.1, 2.5),
          wall(4.6, 4), {{0, 0, -1}, 1.1}, {{0, 0, 1}, 2.2}};
}

inline std::vector<RoomPlane> FloorAndCeiling() { return {{{0, 0, -1}, 1.1}, {{0, 0, 1}, 2.2}}; }

/// How a room is swept.
struct RoomSweep {
  double first_scan_rad = -0.8, last_scan_rad = 3.14159265358979 + 0.8;
  double first_motor_rad = -3.14159265358979, turn_rad = 2 * 3.14159265358979;
  int lines = 180, beams = 160;
  double sigma_m = 0.01;
};

/// Standard normal, after Box and Muller.
inline double Normal(Random* random) {
  const double u = random->Uniform(1e-12, 1), v = random->Uniform(0, 2 * M_PI);
  return std::sqrt(-2 * std::log(u)) * std::cos(v);
}

/// Ranges by cutting each beam with the nearest plane ahead; noise of `sweep.sigma_m`. The
/// docstring of TurnedScanner by Eigen's own rotations, no code of the estimator.
inline TurnedBeams SweepRoom(const std::vector<RoomPlane>& room, const Rigid3& motor_from_scanner,
                             const RoomSweep& sweep, Random* random) {
  TurnedBeams beams;
  for (int line = 0; line < sweep.lines; ++line) {
    for (int beam = 0; beam < sweep.beams; ++beam) {
      const double share = static_cast<double>(beam) / sweep.beams;
      const double motor = sweep.first_motor_rad + sweep.turn_rad * (line + share) / sweep.lines;
      const double a = sweep.first_scan_rad + share * (sweep.last_scan_rad - sweep.first_scan_rad);
      const Eigen::AngleAxisd turn(motor, Eigen::Vector3d::UnitZ());
      const Eigen::Vector3d origin = turn * motor_from_scanner.translation;
      const Eigen::Vector3d direction =
          turn * (motor_from_scanner.rotation * Eigen::Vector3d(std::cos(a), 0, std::sin(a)));
      double range = std::numeric_limits<double>::infinity();
      for (const RoomPlane& plane : room) {
        const double met = (plane.offset - plane.normal.dot(origin)) / plane.normal.dot(direction);
        if (met > 0) range = std::min(range, met);
      }
      if (range > 20) continue;
      beams.motor_rad.push_back(motor);
      beams.scan_rad.push_back(a);
      beams.range_m.push_back(range + sweep.sigma_m * Normal(random));
    }
  }
  return beams;
}

/// A scanner somewhat off the axis and tilted.
inline TurnedScanner TiltedScanner() {
  TurnedScanner scanner;
  scanner.motor_from_scanner =
      Exp((Vector6d() << 0.01, -0.02, 0.015, 0.03, -0.02, 0.08).finished());
  scanner.ticks_per_rad = 1000;
  return scanner;
}

/// `scanner` with motor_from_scanner = Exp(delta) * its own.
inline TurnedScanner Moved(TurnedScanner scanner, const Vector6d& delta) {
  scanner.motor_from_scanner = Exp(delta) * scanner.motor_from_scanner;
  return scanner;
}

}  // namespace rgbdt
