#include "calib/camera/project_points.h"

#include <cmath>

namespace rgbdt {

// And of a margin round the image: what lies there may hide what lies inside.
ViewBounds::ViewBounds(const Camera& camera) {
  constexpr double kMargin = 0.15;  // of the image's width and height, as slopes
  constexpr int kSteps = 24;        // along each border
  if (camera.lens().model == Lens::Model::kFisheye) return;
  const Eigen::Vector2d size(camera.width() - 1, camera.height() - 1);
  Eigen::Array2d least = Eigen::Array2d::Constant(1e9);
  Eigen::Array2d most = -least;
  for (int i = 0; i <= kSteps; ++i) {
    const double along = static_cast<double>(i) / kSteps;
    for (const double across : {0.0, 1.0}) {
      for (const Eigen::Vector2d& place : {Eigen::Vector2d(along, across), {across, along}}) {
        const auto ray = camera.Unproject(place.cwiseProduct(size));
        if (!ray) return;  // the lens folds back before that
        const Eigen::Array2d slope = ray->head<2>().array() / ray->z();
        least = least.min(slope);
        most = most.max(slope);
      }
    }
  }
  const Eigen::Array2d margin = kMargin * (most - least);
  bounded_ = true;
  left_ = static_cast<float>(least.x() - margin.x());
  right_ = static_cast<float>(most.x() + margin.x());
  top_ = static_cast<float>(least.y() - margin.y());
  bottom_ = static_cast<float>(most.y() + margin.y());
}

bool ViewBounds::MayShow(const Eigen::Vector3f& middle, const Eigen::Vector3f& half) const {
  if (!bounded_) return true;
  const float far = middle.z() + half.z();
  if (!(far > 0)) return std::isnan(far);
  const float near = std::max(0.0F, middle.z() - half.z());
  const Eigen::Vector3f least = middle - half;
  const Eigen::Vector3f most = middle + half;
  return !(least.x() > std::max(right_ * near, right_ * far) ||
           most.x() < std::min(left_ * near, left_ * far) ||
           least.y() > std::max(bottom_ * near, bottom_ * far) ||
           most.y() < std::min(top_ * near, top_ * far));
}

BlockedPoints::BlockedPoints(const std::vector<Eigen::Vector3f>& points) : points_(points) {
  for (std::size_t first = 0; first < points.size(); first += PixelBlock::kSize) {
    Eigen::Array3f least, most;
    const std::size_t end = std::min(points.size(), first + PixelBlock::kSize);
    FindBox(points[first].data(), end - first, least.data(), most.data());
    boxes_.push_back({0.5F * (least + most), 0.5F * (most - least)});
  }
}

PointProjector::PointProjector(const Camera& camera, const Rigid3& camera_from_points)
    : kernel_{},
      rotation_(camera_from_points.rotation.toRotationMatrix().cast<float>()),
      translation_(camera_from_points.translation.cast<float>()) {
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

void PointProjector::Project(const Eigen::Vector3f* points, std::size_t count,
                             PixelBlock* block) const {
  static_assert(sizeof(Eigen::Vector3f) == 3 * sizeof(float));
  ProjectKernel(kernel_, points->data(), count, {block->u, block->v, block->inverse_range});
}

bool PointProjector::MayShow(const ViewBounds& view, const BlockedPoints::Box& box) const {
  return kernel_.rolls ||
         view.MayShow(rotation_ * box.middle + translation_, rotation_.cwiseAbs() * box.half);
}

}  // namespace rgbdt
