#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "calib/model/cloud.h"
#include "calib/model/rig.h"
#include "calib/simulate/options.h"
#include "calib/simulate/world.h"

namespace rgbdt::simulate {

/// One sub-ray of a beam that met a surface.
struct SubReturn {
  double range = 0;  ///< [m]
  double reflectivity = 0;
};

struct BeamReturn {
  double range = 0;      ///< [m]; NaN: nothing returned
  double intensity = 0;  ///< reflectivity seen by the whole beam, range compensated
};

/// What a beam of `sub_rays` equal shares reports. Each return has energy reflectivity * share /
/// range^2. Returns within `merge_m` of the next merge to their energy-weighted mean range; of what
/// remains the strongest is reported, unless it is weaker than `min_return` of what the whole beam
/// would return from the white wall at that range. `returns` is sorted.
BeamReturn CombineReturns(const ScannerOptions& options, int sub_rays,
                          std::vector<SubReturn>* returns);

/// The 2D scanner on its motor.
class Scanner {
 public:
  Scanner(const ScannerOptions& options, std::uint64_t seed);

  const TurnedScanner& geometry() const { return geometry_; }
  int sweep_lines() const;
  Utime line_period() const;
  /// Motor's angle [rad] this long after the sweep's start; stands before it and after its end.
  double MotorAngle(double seconds) const;
  std::int64_t Ticks(double motor_angle) const;
  /// Scanner's centre in the LIDAR frame at a motor angle.
  Eigen::Vector3d Centre(double motor_angle) const;

  /// One beam without noise, at a motor angle.
  BeamReturn Beam(const World& world, int beam, double motor_angle) const;
  LineScan Line(const World& world, Utime sweep_utime, int line) const;

 private:
  ScannerOptions options_;
  std::uint64_t seed_;
  TurnedScanner geometry_;
  std::vector<Eigen::Vector3d> sub_rays_;  ///< of beam after beam, motor's frame, unit
  int sub_ray_count_ = 0;                  ///< per beam
};

}  // namespace rgbdt::simulate
