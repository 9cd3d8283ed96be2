#pragma once

#include <Eigen/Core>

#include "calib/camera/camera.h"

namespace rgbdt {

/// A camera's projection, continued to every direction: what an objective needs that is to lead
/// back from where the camera sees nothing. Up to the angle of the image's farthest corner it is
/// the camera's own; beyond, the pixel moves on outwards as fast as it did there, for each radian
/// off the axis. So value and slope are continuous all round, but for straight behind the camera,
/// which no side is nearer to.
class ExtrapolatedProjection {
 public:
  /// `camera` outlives it.
  explicit ExtrapolatedProjection(const Camera* camera);

  /// Always finite for finite points.
  Eigen::Vector2d Project(const Eigen::Vector3d& point_in_camera) const;

  /// The angle off the axis up to which the lens is asked [rad].
  double limit() const { return limit_; }

 private:
  Eigen::Vector2d Beyond(double angle, const Eigen::Vector2d& towards) const;

  const Camera* camera_;
  double limit_ = 0;
};

}  // namespace rgbdt
