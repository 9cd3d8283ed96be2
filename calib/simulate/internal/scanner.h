#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "calib/model/cloud.h"
#include "calib/model/rig.h"
#include "calib/simulate/internal/beam.h"
#include "calib/simulate/internal/world.h"
#include "calib/simulate/options.h"

namespace rgbdt::simulate {

/// The 2D scanner on its motor.
class Scanner {
 public:
  Scanner(const ScannerOptions& options, std::uint64_t seed);

  const TurnedScanner& geometry() const { return geometry_; }
  int sweep_lines() const;
  Utime line_period() const;
  /// Whether sweeps go from their end to their start from now on.
  void SweepBack(bool back) { back_ = back; }
  /// Motor's angle [rad] this long after the sweep's start; stands before it and after its end.
  double MotorAngle(double seconds) const;
  std::int64_t Ticks(double motor_angle) const;
  /// Scanner's centre in the LIDAR frame at a motor angle.
  Eigen::Vector3d Centre(double motor_angle) const;

  /// world_from_lidar at a time, of a rig that drives; empty: it stands at the world's origin.
  using Way = std::function<Rigid3(Utime utime)>;

  /// One beam without noise, at a motor angle.
  BeamReturn Beam(const World& world, int beam, double motor_angle,
                  const Rigid3& world_from_lidar = {}) const;
  LineScan Line(const World& world, Utime sweep_utime, int line, const Way& way = {}) const;
  /// A line that begins at `utime`, wherever the motor is: its angle [rad] so many seconds later.
  LineScan LineAt(const World& world, Utime utime,
                  const std::function<double(double seconds)>& motor_angle,
                  const Way& way = {}) const;
  /// A whole sweep, line x beam, with the motor's true angles (an encoder reads whole ticks); each
  /// point in the LIDAR's frame of its own time.
  Cloud Sweep(const World& world, Utime sweep_utime, int threads, const Way& way = {}) const;

 private:
  void AddLine(const LineScan& scan, int line, Cloud* cloud) const;

  ScannerOptions options_;
  std::uint64_t seed_;
  TurnedScanner geometry_;
  std::vector<Eigen::Vector3d> sub_rays_;  ///< of beam after beam, motor's frame, unit
  int sub_ray_count_ = 0;                  ///< per beam
  bool back_ = false;
};

}  // namespace rgbdt::simulate
