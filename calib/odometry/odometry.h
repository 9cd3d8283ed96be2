#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "calib/model/cloud.h"
#include "calib/model/rigid3.h"

namespace rgbdt {

struct OdometryOptions {
  double min_range_m = 0.8;  ///< nearer points are the rig's own
  double max_range_m = 100;
  double range_sigma_m = 0.01;       ///< noise of a range
  std::size_t selected = 2500;       ///< points of a sweep that are matched, about
  double acceleration_mps2 = 0.8;    ///< along each axis, 1 sigma: what the rig does unseen
  double turn_radps2 = 1.5;          ///< [rad/s^2] about each axis, 1 sigma
  double degenerate_m = 0.03;        ///< what a sweep tells of a direction worse is not told
  double keep_m = 100;               ///< what is farther than this from the rig is forgotten
  std::size_t max_voxels = 2000000;  ///< of the map, all sizes together; 300 to 600 bytes each

  /// Throws InputError naming the field and its value.
  void Check() const;
};

struct PoseAtTime {
  Utime utime = 0;
  Rigid3 world_from_lidar;
};

/// What a sweep tells of where the LIDAR is.
struct OdometryResult {
  Utime utime = 0;  ///< of the pose: when the sweep's last point was taken; of a way its end, some
                    ///< time before that
  Rigid3 world_from_lidar;   ///< world: the LIDAR in the middle of the first sweep
  Utime middle_utime = 0;    ///< half-way between the sweep's first and last point
  Rigid3 world_from_middle;  ///< world_from_lidar at that time, when it is known best
  /// (rx, ry, rz [rad/s], tx, ty, tz [m/s]) in the LIDAR's axes: at a time t of the sweep
  /// world_from_lidar = world_from_middle * Exp((t - middle_utime) * velocity).
  Vector6d velocity = Vector6d::Zero();
  /// Of delta in LIDAR axes, truth = world_from_lidar * Exp(delta): against the map of the last
  /// keep_m of the way. How far that map has drifted from the start is not in it.
  Matrix6d covariance = Matrix6d::Zero();
  bool converged = false;  ///< false: the pose is as the motion before goes on, see `reason`
  std::string reason;      ///< why not; of a restart, too
  /// The sweep is a turned scanner's, for which the rig stood: from first_utime to utime at
  /// world_from_lidar.
  bool standing = false;
  /// Where it was during a turned scanner's sweep for which it did not stand, from first_utime to
  /// utime, ten a second; straight on in between. It begins where the way of the sweep before
  /// ended; the velocity is that in the sweep's middle only. Empty otherwise.
  std::vector<PoseAtTime> way;
  Utime first_utime = 0;   ///< of the sweep's first point; of a way its begin
  bool restarted = false;  ///< the map was begun anew: the way since the last pose is a guess
  /// Directions that the sweep does not tell, in words; there the pose goes on as before.
  std::vector<std::string> degenerate;
  std::size_t points = 0;    ///< of the sweep, of use
  std::size_t selected = 0;  ///< looked for on the map's planes
  std::size_t matched = 0;   ///< found on one
  double residual_m = 0;     ///< median distance of these
  int iterations = 0;
};

/// Where a LIDAR stood for a sweep, in the axes of all stops of the same world: those of the first
/// one. How worlds lie to each other is not known.
struct StopPlace {
  int world = 0;
  Rigid3 world_from_lidar;
};

/// Where a LIDAR is, from its sweeps alone: each is registered, points to planes, to a map of the
/// sweeps before. A spinning LIDAR moves while it sweeps. The rig of a turned scanner, whose sweeps
/// last longer than kMostSweep, stands for the first; then it either stands for each and goes on by
/// up to some metres in between, or drives on while it sweeps, one sweep behind the other. Its
/// README has the method and its sources. The same sweeps in the same order give the same poses,
/// bit for bit. One core.
class Odometry {
 public:
  static constexpr double kMostSweep = 0.6;  ///< [s] a longer sweep is a turned scanner's
  static constexpr double kMostStop = 120;   ///< [s] and a longer one nobody's
  static constexpr double kMostGap = 1.0;    ///< [s] between a spinning LIDAR's sweeps; after more:
                                             ///< begun anew. Between a turned scanner's, while
                                             ///< the rig drives
  static constexpr int kMostLost = 5;        ///< sweeps in a row that do not fit; then: begun anew

  explicit Odometry(const OdometryOptions& options = {});
  ~Odometry();
  Odometry(Odometry&&) noexcept;
  Odometry& operator=(Odometry&&) noexcept;

  /// Throws InputError for the part of a sweep that one message brings, whose vectors differ in
  /// length, whose times lie more than kMostStop from the sweep's, or apart from one another.
  static void CheckTimes(const Cloud& message);

  /// Takes the next sweep; one without times counts as seen at one moment. A sweep with too few
  /// points, or that does not fit, is a result that is not converged. Throws InputError, and is as
  /// if it had never come, for a sweep whose vectors differ in length, which lasts too long, which
  /// is a turned scanner's where the ones before are a spinning LIDAR's or the other way round, or
  /// which is not newer than the one before (more than ten seconds older: the clock was set back,
  /// and the map is begun anew).
  OdometryResult Add(const Cloud& sweep);

  /// Where a LIDAR of any kind stood for each of some sweeps, in the order in which it came by,
  /// upright within some degrees: each is registered to the map of those before (README, "Stop and
  /// scan"); where it fits two places about as well, the better one is taken. One that fits
  /// nowhere, or has too few points, is a world of its own. When they were taken is not looked at.
  static std::vector<StopPlace> FindStops(const std::vector<const Cloud*>& sweeps,
                                          const OdometryOptions& options = {});

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rgbdt
