#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calib/camera/lens.h"
#include "calib/model/rig.h"

namespace rgbdt {

/// A camera's geometry: which pixel sees a point, and where a pixel looks. Camera axes: x right,
/// y down, z forward. Pixel centres at integers.
class Camera {
 public:
  explicit Camera(const CameraSpec& spec);

  /// The pixel of a point in camera axes. Nothing where the point is behind the camera or beyond
  /// the angle at which the distortion polynomial folds back (a second, false image lies there).
  /// The pixel may lie outside the image.
  std::optional<Eigen::Vector2d> Project(const Eigen::Vector3d& point_in_camera) const;

  /// The unit direction in which a pixel looks. Nothing where no direction maps to that pixel.
  std::optional<Eigen::Vector3d> Unproject(const Eigen::Vector2d& pixel) const;

  /// Whether a pixel lies in the image, where bilinear sampling has all four neighbours.
  bool Contains(const Eigen::Vector2d& pixel) const {
    return pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() <= width_ - 1 && pixel.y() <= height_ - 1;
  }

  int width() const { return width_; }
  int height() const { return height_; }
  const Lens& lens() const { return lens_; }

  /// Angle off the axis up to which the lens model holds [rad].
  double max_angle() const { return max_angle_; }

 private:
  Lens lens_;
  int width_ = 0;
  int height_ = 0;
  double max_angle_ = 0;
  double min_cos_angle_ = 0;
};

/// The image of a straight line segment in camera axes, as a chain of `pieces` + 1 pixels; what
/// cannot be seen is left out.
std::vector<Eigen::Vector2d> ProjectSegment(const Camera& camera, const Eigen::Vector3d& from,
                                            const Eigen::Vector3d& to, int pieces);

}  // namespace rgbdt
