#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "calib/model/cloud.h"
#include "calib/odometry/internal/moving_sweep.h"
#include "calib/odometry/internal/plane_map.h"
#include "calib/odometry/internal/registration.h"
#include "calib/odometry/internal/way_registration.h"
#include "calib/odometry/odometry.h"

namespace rgbdt {
namespace odometry {

constexpr double kLeastBad = 0.02;  ///< [m] nearer to its planes than this no sweep is called bad

double ShareOf(std::size_t matched, std::size_t selected);

/// `format` with two numbers.
std::string Text(const char* format, double a, double b);

}  // namespace odometry

/// The map and what is known of the motion; turned_scanner.cc has what a turned scanner's sweeps
/// ask for, odometry.cc all else.
struct Odometry::Impl {
  explicit Impl(const OdometryOptions& o) : options(o), map(o.range_sigma_m) {}

  OdometryOptions options;
  odometry::PlaneMap map;
  bool turned = false;                        // the sweeps are a turned scanner's
  std::optional<odometry::TimedSweep> first;  // while the second has not come
  bool begun = false;                         // the map holds something, or `first` does
  bool anew = false;                          // there was a map before
  Utime sweep_utime = 0;                      // of the newest sweep
  Utime middle = 0;                           // of `motion`
  odometry::Motion motion;                    // after a turned scanner's sweep: at its end
  Utime last = 0;                             // point of the newest sweep
  std::vector<odometry::TimedSweep> open;     // parts of it that the next one is to tell of
  int lost = 0;
  int refused = 0;              // in a row, as of another kind of LIDAR
  double usual_residual_m = 0;  // of the sweeps before; 0: not known
  double usual_share = 0;       // of their points, on planes seen before
  double usual_near = 0;        // and so near that they lie on them
  Eigen::Vector3d forgotten_at{0, 0, 0};

  OdometryResult Add(const Cloud& cloud);
  double Since(const Cloud& cloud, const odometry::TimedSweep& sweep);
  void Begin(const odometry::TimedSweep& sweep);
  void Lose(const odometry::TimedSweep& sweep, double seconds);
  void Follow(const odometry::TimedSweep& sweep, double seconds, OdometryResult* result);
  odometry::Registration Second(const odometry::TimedSweep& sweep);
  odometry::Registration Next(const odometry::TimedSweep& sweep, const odometry::Motion& before,
                              double seconds) const;
  std::string WhyNot(std::size_t selected, const odometry::Registration& found,
                     const odometry::Motion& before, double seconds) const;
  void Place(const odometry::Registration& found, std::size_t selected, OdometryResult* result);
  void Forget(const Eigen::Vector3d& place);
  void Grow(const odometry::TimedSweep& sweep);
  void Report(const odometry::TimedSweep& sweep, OdometryResult* result) const;
  static void Tell(const odometry::Registration& found, OdometryResult* result);

  // Turned scanners.
  void FollowTurned(const Cloud& cloud, const odometry::TimedSweep& sweep, OdometryResult* result);
  bool Found(const odometry::TimedSweep& stop);
  std::string WhyNotTurned(std::size_t selected, const odometry::Registration& found,
                           const odometry::Motion& before) const;
  bool Drive(const Cloud& cloud, const odometry::TimedSweep& sweep, double stood,
             OdometryResult* result);
  bool IsWay(const odometry::WayRegistration& way, std::size_t settled) const;
  void ReportWay(const odometry::TimedSweep& sweep, const std::vector<odometry::TimedSweep>& parts,
                 const odometry::WayRegistration& way, std::size_t settled,
                 OdometryResult* result) const;
};

}  // namespace rgbdt
