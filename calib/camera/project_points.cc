#include "calib/camera/project_points.h"

#include <cmath>

namespace rgbdt {

void PixelColumns::Resize(std::size_t size) {
  u.resize(size);
  v.resize(size);
  inverse_range.resize(size);
}

PointProjector::PointProjector(const Camera& camera, const Rigid3& camera_from_points) : kernel_{} {
  const Lens& lens = camera.lens();
  kernel_.fisheye = lens.model == Lens::Model::kFisheye;
  kernel_.fx = static_cast<float>(lens.fx);
  kernel_.fy = static_cast<float>(lens.fy);
  kernel_.cx = static_cast<float>(lens.cx);
  kernel_.cy = static_cast<float>(lens.cy);
  kernel_.min_cos_angle = static_cast<float>(std::cos(camera.max_angle()));
  kernel_.middle_row = 0.5F * static_cast<float>(camera.height() - 1);
  const Eigen::Matrix3d rotation = camera_from_points.rotation.toRotationMatrix();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      kernel_.rotation[3 * row + column] = static_cast<float>(rotation(row, column));
    }
    kernel_.translation[row] = static_cast<float>(camera_from_points.translation[row]);
  }
  for (std::size_t i = 0; i < 8; ++i) {
    kernel_.distortion[i] = static_cast<float>(lens.distortion[i]);
  }
}

void PointProjector::SetMotion(const Vector6d& delta_per_row) {
  kernel_.rolls = delta_per_row.norm() > 0;
  for (int i = 0; i < 6; ++i) kernel_.delta_per_row[i] = static_cast<float>(delta_per_row[i]);
}

void PointProjector::Project(const float* points, std::size_t first, std::size_t count,
                             PixelColumns* pixels) const {
  ProjectKernel(
      kernel_, points + 3 * first, count,
      {pixels->u.data() + first, pixels->v.data() + first, pixels->inverse_range.data() + first});
}

}  // namespace rgbdt
