#pragma once

#include <cstddef>
#include <vector>

#include "calib/camera/camera.h"
#include "calib/camera/project_kernel.h"
#include "calib/model/rigid3.h"

namespace rgbdt {

/// Where points lie in an image, one array for each number: what loops over millions of points read
/// and write. All three 0 for a point that the lens does not see (Camera::Project).
struct PixelColumns {
  std::vector<float> u, v;           ///< [px]; may lie outside of the image
  std::vector<float> inverse_range;  ///< 1 / distance from the camera's centre [1/m]

  std::size_t size() const { return u.size(); }
  void Resize(std::size_t size);
};

/// Projects many points through one camera at one place. Single precision: within 0.002 px of
/// Camera::Project in an image of 4000 px.
class PointProjector {
 public:
  PointProjector(const Camera& camera, const Rigid3& camera_from_points);

  /// For a camera that moves while it is read out: how camera_from_points changes from one image
  /// row to the next, Exp(row - middle row times this) * camera_from_points; camera axes.
  void SetMotion(const Vector6d& delta_per_row);

  /// Points [first, first + count), three floats each [m], to the same places of `pixels`, which is
  /// long enough. A few nanoseconds a point.
  void Project(const float* points, std::size_t first, std::size_t count,
               PixelColumns* pixels) const;

 private:
  KernelProjection kernel_;
};

}  // namespace rgbdt
