#include "calib/methods/paper/internal/extrapolated_projection.h"

#include <algorithm>
#include <cmath>

#include "calib/camera/pixel_by_point.h"

namespace rgbdt {
namespace {

double FarthestCorner(const Camera& camera) {
  // Short of where the lens model folds back: there its slope ends.
  const double most = 0.98 * camera.max_angle();
  double farthest = 0;
  for (const double u : {0.0, camera.width() - 1.0}) {
    for (const double v : {0.0, camera.height() - 1.0}) {
      const auto direction = camera.Unproject({u, v});
      const double angle =
          direction ? std::atan2(direction->head<2>().norm(), direction->z()) : most;
      farthest = std::max(farthest, angle);
    }
  }
  return std::min(farthest, most);
}

}  // namespace

ExtrapolatedProjection::ExtrapolatedProjection(const Camera* camera)
    : camera_(camera), limit_(FarthestCorner(*camera)) {}

Eigen::Vector2d ExtrapolatedProjection::Project(const Eigen::Vector3d& p) const {
  const double aside = p.head<2>().norm();
  const double angle = std::atan2(aside, p.z());
  if (angle <= limit_) {
    const auto pixel = camera_->Project(p);
    if (pixel) return *pixel;
  }
  // No side is nearer to what lies on the axis: any one will do.
  return Beyond(angle, aside > 0 ? Eigen::Vector2d(p.head<2>() / aside) : Eigen::Vector2d(1, 0));
}

Eigen::Vector2d ExtrapolatedProjection::Beyond(double angle, const Eigen::Vector2d& towards) const {
  const double sine = std::sin(limit_);
  const double cosine = std::cos(limit_);
  const Eigen::Vector3d last(sine * towards.x(), sine * towards.y(), cosine);
  const Eigen::Vector3d onwards(cosine * towards.x(), cosine * towards.y(), -sine);
  Eigen::Vector2d pixel;
  ProjectUnchecked(camera_->lens(), last.x(), last.y(), last.z(), &pixel.x(), &pixel.y());
  return pixel + (angle - limit_) * PixelByPoint(camera_->lens(), last) * onwards;
}

}  // namespace rgbdt
