#include "calib/camera/camera.h"

#include <cmath>

namespace rgbdt {
namespace {

constexpr double kPi = 3.14159265358979323846;

// Distorted radius of a ray at `angle` off the axis, radial terms only.
double DistortedRadius(const Lens& lens, double angle) {
  if (lens.model == Lens::Model::kFisheye) {
    return FisheyeLens::Radius(lens.distortion.data(), angle);
  }
  const double r = std::tan(angle);
  return r * PinholeLens::Radial(lens.distortion.data(), r * r);
}

// The angle up to which the distorted radius grows: beyond it the polynomial folds back.
double FoldAngle(const Lens& lens) {
  // At kPi itself, straight behind a fisheye, there is no direction in the image to go to.
  const double limit = (lens.model == Lens::Model::kFisheye ? kPi : 0.5 * kPi) - 1e-3;
  constexpr int kSteps = 4000;
  double previous = 0;
  for (int i = 1; i <= kSteps; ++i) {
    const double radius = DistortedRadius(lens, limit * i / kSteps);
    if (!(radius > previous)) return limit * (i - 1) / kSteps;
    previous = radius;
  }
  return limit;
}

// Direction at `angle` off the axis towards (cos, sin).
Eigen::Vector3d Direction(double angle, double cosine, double sine) {
  return {std::sin(angle) * cosine, std::sin(angle) * sine, std::cos(angle)};
}

// Solves DistortedRadius(angle) = radius by bisection: the radius grows up to max_angle.
double AngleOfRadius(const Lens& lens, double radius, double max_angle) {
  double low = 0;
  double high = max_angle;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (DistortedRadius(lens, middle) < radius ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

Camera::Camera(const CameraSpec& spec)
    : lens_(spec.lens),
      width_(spec.width),
      height_(spec.height),
      max_angle_(FoldAngle(spec.lens)),
      min_cos_angle_(std::cos(max_angle_)) {}

std::optional<Eigen::Vector2d> Camera::Project(const Eigen::Vector3d& p) const {
  const double norm = p.norm();
  if (!(norm > 1e-9) || !(p.z() >= min_cos_angle_ * norm)) return std::nullopt;
  if (lens_.model == Lens::Model::kPinhole && !(p.z() > 1e-9)) return std::nullopt;
  Eigen::Vector2d pixel;
  ProjectUnchecked(lens_, p.x(), p.y(), p.z(), &pixel.x(), &pixel.y());
  if (!pixel.allFinite()) return std::nullopt;
  return pixel;
}

std::optional<Eigen::Vector3d> Camera::Unproject(const Eigen::Vector2d& pixel) const {
  const Eigen::Vector2d wanted((pixel.x() - lens_.cx) / lens_.fx,
                               (pixel.y() - lens_.cy) / lens_.fy);
  const double radius = wanted.norm();
  const double angle = AngleOfRadius(lens_, radius, max_angle_);
  if (angle >= max_angle_ * (1 - 1e-9)) return std::nullopt;
  const Eigen::Vector2d towards =
      radius > 1e-12 ? Eigen::Vector2d(wanted / radius) : Eigen::Vector2d(1, 0);
  Eigen::Vector3d direction = Direction(angle, towards.x(), towards.y());
  if (lens_.model == Lens::Model::kFisheye) return direction;

  // The tangential terms: Newton from the radial solution, derivatives by differences.
  Eigen::Vector2d x(direction.x() / direction.z(), direction.y() / direction.z());
  const auto distort = [&](const Eigen::Vector2d& at) {
    Eigen::Vector2d out;
    PinholeLens::Distort(lens_.distortion.data(), at.x(), at.y(), &out.x(), &out.y());
    return out;
  };
  for (int i = 0; i < 20; ++i) {
    const Eigen::Vector2d residual = wanted - distort(x);
    if (residual.norm() < 1e-14) break;
    constexpr double kStep = 1e-6;
    Eigen::Matrix2d jacobian;
    for (int axis = 0; axis < 2; ++axis) {
      const Eigen::Vector2d step = kStep * Eigen::Vector2d::Unit(axis);
      jacobian.col(axis) = (distort(x + step) - distort(x - step)) / (2 * kStep);
    }
    x += jacobian.inverse() * residual;
  }
  if (!x.allFinite() || (wanted - distort(x)).norm() > 1e-9) return std::nullopt;
  direction = Eigen::Vector3d(x.x(), x.y(), 1).normalized();
  if (direction.z() < min_cos_angle_) return std::nullopt;
  return direction;
}

std::vector<Eigen::Vector2d> ProjectSegment(const Camera& camera, const Eigen::Vector3d& from,
                                            const Eigen::Vector3d& to, int pieces) {
  std::vector<Eigen::Vector2d> chain;
  chain.reserve(static_cast<std::size_t>(pieces) + 1);
  for (int i = 0; i <= pieces; ++i) {
    const auto pixel = camera.Project(from + (to - from) * (static_cast<double>(i) / pieces));
    if (pixel) chain.push_back(*pixel);
  }
  return chain;
}

}  // namespace rgbdt
