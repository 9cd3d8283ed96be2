#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "calib/odometry/loop_colours.h"
#include "calib/odometry/odometry.h"

namespace rgbdt {

struct LoopClosureOptions {
  double keyframe_m = 2;             ///< way between two sweeps that are kept
  double keyframe_rad = 0.35;        ///< likewise, turn
  std::size_t max_keyframes = 2000;  ///< about 220 kB each; then every second one goes
  std::size_t map_points = 8000;     ///< of a sweep, for the map about it
  double about_m = 16;               ///< how far along the way the map about a place reaches
  double least_way_m = 40;           ///< from a place until it counts as come back to
  double most_unlike = 0.45;         ///< of places, 0 to 1: what is less alike is not tried
  double drift_share = 0.01;         ///< of the way, 1 sigma: how far odometry may be off
  double drift_radpm = 2e-4;         ///< [rad/m] likewise, its turn

  /// Throws InputError naming the field and its value.
  void Check() const;
};

/// Sweeps of a drive, one every keyframe_m of the way, with the poses that odometry found: what
/// loops are closed by. Memory is bounded: when there are max_keyframes, every second one is
/// forgotten, and from then on they are twice as far apart.
class Keyframes {
 public:
  explicit Keyframes(const LoopClosureOptions& options = {}, const OdometryOptions& odometry = {});
  ~Keyframes();
  Keyframes(Keyframes&&) noexcept;
  Keyframes& operator=(Keyframes&&) noexcept;

  /// A sweep and what odometry says of it, in the order of time. One that is not converged is left
  /// out; after one that is `restarted` the way since the one before is taken as unknown. Throws
  /// InputError as Odometry::Add does.
  void Add(const Cloud& sweep, const OdometryResult& found);
  std::size_t size() const;

 private:
  friend struct ClosedWay CloseLoops(const Keyframes& keyframes, const LoopColours& colours);
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// A place that the way came back to.
struct ClosedLoop {
  Utime old_utime = 0, new_utime = 0;  ///< middles of the two sweeps
  Rigid3 old_from_new;                 ///< LIDAR frames at these times, by registration
  ColoursAlike colours;                ///< of both places
  double sigma_factor = 1;             ///< by which its sigma was enlarged, as these differ
};

/// A drive's way after its loops were closed.
struct ClosedWay {
  std::vector<ClosedLoop> loops;     ///< in the order of new_utime
  std::size_t tried = 0;             ///< pairs of places that looked alike, or lay near each other
  std::size_t do_not_fit = 0;        ///< of these: the sweep does not lie on the earlier map
  std::size_t against_odometry = 0;  ///< odometry cannot be off by so much
  std::size_t alone = 0;             ///< fewer than two others nearby bear it out
  std::size_t contradict = 0;        ///< what is kept contradicts it
  bool solved = true;                ///< false: no solution, the way is as it was
  double most_moved_m = 0;           ///< of a keyframe
  double end_moved_m = 0;            ///< of the last one

  std::vector<Utime> utimes;          ///< of keyframes, rising
  std::vector<Rigid3> before, after;  ///< world_from_lidar at these times

  std::size_t refused() const { return do_not_fit + against_odometry + alone + contradict; }
  /// Where the LIDAR was at a time of which odometry said `world_from_lidar`: moved as the
  /// keyframes before and after it. Without a loop: the same, to the bit.
  Rigid3 Corrected(Utime utime, const Rigid3& world_from_lidar) const;
};

/// Finds where a drive came back to a place, whichever way the LIDAR looked, and corrects the way
/// for what odometry drifted by in between.
///
/// Places are known again by how high things stand about them (Scan Context: Kim and Kim, IROS
/// 2018), and by odometry where it has them near each other. The later sweep is registered, points
/// to planes, on the map about the earlier place. The way is then solved from the ways between
/// keyframes and the loops, each weighed by its covariance (a pose graph: Lu and Milios 1997;
/// Grisetti et al. 2010), by Ceres. A wrong loop does more harm than one that is missed: a loop is
/// refused where the sweep does not lie on the map as it did on that of its own time, where
/// odometry cannot be off by so much, where loops nearby do not agree with it (as pairwise
/// consistency: Mangelson et al. 2018), and where the solved way contradicts it (chi-square). What
/// cameras saw of both places weighs a loop (LoopColours::SigmaFactor); without it all weigh alike.
///
/// The first keyframe stays where it was. The same sweeps give the same way, bit for bit. One core.
ClosedWay CloseLoops(const Keyframes& keyframes, const LoopColours& colours = {});

}  // namespace rgbdt
