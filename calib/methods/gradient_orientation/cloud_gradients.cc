#include "calib/methods/gradient_orientation/cloud_gradients.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <optional>

#include "calib/detect/cloud/range_grid.h"

namespace rgbdt {
namespace {

struct Sample {
  Eigen::Vector3d direction;
  double value = 0;
  std::size_t point = 0;
};

class Gradients {
 public:
  Gradients(const Cloud& cloud, CloudFeature feature)
      : cloud_(cloud), feature_(feature), grid_(cloud) {}

  std::vector<CloudGradient> All() const {
    std::vector<CloudGradient> all;
    for (int row = 0; row < grid_.rows(); ++row) {
      for (int column = 0; column < grid_.columns(); ++column) {
        if (const auto gradient = At(row, column)) all.push_back(*gradient);
      }
    }
    return all;
  }

 private:
  // Of several points in a cell the one that stands first.
  std::optional<Sample> SampleAt(int row, int column) const {
    if (!grid_.Contains(row, column)) return std::nullopt;
    const std::size_t cell = grid_.Cell(row, column);
    if (!grid_.IsHit(cell)) return std::nullopt;
    std::optional<Sample> sample;
    grid_.ForEachPoint(cell, [&](const Eigen::Vector3f& point, std::size_t i) {
      if (sample) return;
      const Eigen::Vector3d ray = point.cast<double>() - grid_.Origin(cell);
      const double value =
          feature_ == CloudFeature::kIntensity ? cloud_.intensity[i] : std::log(ray.norm());
      sample = Sample{ray.normalized(), value, i};
    });
    return sample;
  }

  // Least squares of a plane through the point, over the angles to its neighbours.
  std::optional<CloudGradient> At(int row, int column) const {
    const auto here = SampleAt(row, column);
    if (!here) return std::nullopt;
    const Eigen::Vector3d e1 = here->direction.unitOrthogonal();
    const Eigen::Vector3d e2 = here->direction.cross(e1);
    Eigen::Matrix2d a = Eigen::Matrix2d::Zero();
    Eigen::Vector2d b = Eigen::Vector2d::Zero();
    int count = 0;
    for (int dr = -1; dr <= 1; ++dr) {
      for (int dc = -1; dc <= 1; ++dc) {
        const auto other = SampleAt(row + dr, column + dc);
        if (!other || (dr == 0 && dc == 0)) continue;
        const Eigen::Vector2d x(other->direction.dot(e1), other->direction.dot(e2));
        a += x * x.transpose();
        b += (other->value - here->value) * x;
        ++count;
      }
    }
    const double determinant = a.determinant();
    if (count < 3 || !(determinant > 1e-4 * a.trace() * a.trace())) return std::nullopt;
    const Eigen::Vector2d slope(a(1, 1) * b.x() - a(0, 1) * b.y(),
                                a(0, 0) * b.y() - a(1, 0) * b.x());
    const double strength = slope.norm() / determinant;
    if (!(strength > 0)) return std::nullopt;
    const Eigen::Vector3d direction = (slope.x() * e1 + slope.y() * e2) / slope.norm();
    return CloudGradient{here->point, direction.cast<float>(), static_cast<float>(strength)};
  }

  const Cloud& cloud_;
  CloudFeature feature_;
  RangeGrid grid_;
};

}  // namespace

std::vector<CloudGradient> GradientsOf(const Cloud& cloud, CloudFeature feature) {
  return Gradients(cloud, feature).All();
}

}  // namespace rgbdt
