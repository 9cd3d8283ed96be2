#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "calib/model/cloud.h"
#include "calib/model/rigid3.h"
#include "calib/odometry/internal/plane_map.h"
#include "calib/odometry/odometry.h"

namespace rgbdt::odometry {

/// A point as the LIDAR saw it, LIDAR frame of its own time.
struct TimedPoint {
  Eigen::Vector3f point;
  float seconds = 0;            ///< after the sweep's middle
  std::uint32_t elevation = 0;  ///< see MapPoint
};

/// What of a sweep is of use.
struct TimedSweep {
  Utime first = 0, middle = 0, last = 0;  ///< first point, half-way between it and the last one
  bool turned = false;  ///< it took longer than Odometry::kMostSweep: a turned scanner's
  double seconds = 0;   ///< from first to last point; 0: the rig stands meanwhile
  std::vector<TimedPoint> points;
  std::vector<TimedPoint> selected;  ///< spread evenly over what was seen
};

/// Throws InputError for vectors that differ in length and for times that are not the sweep's.
void CheckTimes(const Cloud& part);
/// The same, and that the points of one message follow one another.
void CheckMessageTimes(const Cloud& part);

/// Throws InputError likewise, and for a sweep that lasts too long.
TimedSweep TimeSweep(const Cloud& cloud, const OdometryOptions& options);

/// A turned scanner's sweep in parts of a tenth of a second, one behind the other: in each the
/// motion may be taken to be constant. One in which nothing returned has no points.
std::vector<TimedSweep> PartsOf(const Cloud& cloud, const OdometryOptions& options);

/// The motion within a sweep, constant in the LIDAR's axes: world_from_middle * Exp(t velocity), by
/// a table; between its places straight on, which is off by less than 0.1 mm.
class SweepMotion {
 public:
  SweepMotion(const Rigid3& world_from_middle, const Vector6d& velocity, double seconds);

  /// The point, as if seen from where the LIDAR was in the sweep's middle.
  Eigen::Vector3d InMiddle(const TimedPoint& p) const {
    const double place = (p.seconds + half_) * per_second_;
    const int k = std::min(kPlaces - 1, std::max(0, static_cast<int>(place + 0.5)));
    const double after = p.seconds - times_[static_cast<std::size_t>(k)];
    const Eigen::Vector3d point = p.point.cast<double>();
    const Step& step = steps_[static_cast<std::size_t>(k)];
    return step.rotation * (point + after * (turn_.cross(point) + speed_)) + step.translation;
  }
  Eigen::Vector3d InWorld(const Eigen::Vector3d& in_middle) const {
    return rotation_ * in_middle + translation_;
  }
  const Eigen::Matrix3d& rotation() const { return rotation_; }

 private:
  static constexpr int kPlaces = 129;
  struct Step {
    Eigen::Matrix3d rotation;
    Eigen::Vector3d translation;
  };
  std::array<Step, kPlaces> steps_;
  std::array<double, kPlaces> times_;
  double half_, per_second_;
  Eigen::Vector3d turn_, speed_;
  Eigen::Matrix3d rotation_;
  Eigen::Vector3d translation_;
};

/// All of a sweep's points in the world.
std::vector<MapPoint> InWorld(const TimedSweep& sweep, const SweepMotion& motion);

}  // namespace rgbdt::odometry
