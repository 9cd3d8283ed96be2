#include "calib/camera/outline_pose.h"

#include <cmath>

#include "calib/model/linear_algebra.h"

namespace rgbdt {
namespace {

using Row6 = Eigen::Matrix<double, 1, 6>;

// An end of a side's curve: where it looks, and how that turns when it moves across the curve.
struct CurveEnd {
  Eigen::Vector3d direction;  // unit, camera axes
  Eigen::Vector3d by_px;      // of direction, for each pixel across the curve
};

// How far beside a curve's end a side lies, and its derivative by delta (TargetPose).
struct Beside {
  double px = 0;
  Row6 by_delta;
  double by_m = 0;  // for each metre that the side lies farther out on the board
};

std::optional<CurveEnd> EndOf(const Camera& camera, const ImageSide& side, bool last) {
  const std::size_t n = side.curve.size();
  const Eigen::Vector2d along = last ? Eigen::Vector2d(side.curve[n - 1] - side.curve[n - 2])
                                     : Eigen::Vector2d(side.curve[1] - side.curve[0]);
  const Eigen::Vector2d across = Eigen::Vector2d(along.y(), -along.x()).normalized();
  const Eigen::Vector2d& at = last ? side.curve[n - 1] : side.curve[0];
  constexpr double kStepPx = 0.5;
  const auto middle = camera.Unproject(at);
  const auto before = camera.Unproject(at - kStepPx * across);
  const auto after = camera.Unproject(at + kStepPx * across);
  if (!middle || !before || !after) return std::nullopt;
  return CurveEnd{*middle, (*after - *before) / (2 * kStepPx)};
}

// The side and the camera's centre span a plane, normal m = a x b: a direction d lies beside it by
// d . m, which changes by by_px . m for each pixel.
Beside BesideOf(const CurveEnd& end, const Rigid3& camera_from_target, const Eigen::Vector3d& from,
                const Eigen::Vector3d& to) {
  const Eigen::Vector3d a = camera_from_target * from;
  const Eigen::Vector3d b = camera_from_target * to;
  const Eigen::Vector3d m = a.cross(b);
  const double scale = -1 / end.by_px.dot(m);
  // Of m: (r x a + t) x b + a x (r x b + t); what the scale changes by is small beside it.
  const Eigen::Matrix3d by_a = -CrossMatrix(b);
  const Eigen::Matrix3d by_b = CrossMatrix(a);
  Beside out;
  out.px = scale * end.direction.dot(m);
  const Eigen::RowVector3d d = scale * end.direction.transpose();
  out.by_delta << -d * by_a * CrossMatrix(a) - d * by_b * CrossMatrix(b), d * (by_a + by_b);
  const Eigen::Vector3d along = (to - from).normalized();
  const Eigen::Vector3d outward =
      camera_from_target.rotation * Eigen::Vector3d(along.y(), -along.x(), 0);
  out.by_m = d.dot((by_a + by_b) * outward);
  return out;
}

struct Normal {
  std::array<Eigen::Matrix2d, 4> covariance;
  Matrix6d h = Matrix6d::Zero();
  Vector6d g = Vector6d::Zero();
  double chi2 = 0;
};

std::optional<Normal> NormalEquations(const Camera& camera, const Target& target,
                                      const std::array<ImageSide, 4>& sides, const Rigid3& pose,
                                      double place_sigma_m) {
  Normal normal;
  const auto corners = target.OutlineCorners();
  for (std::size_t i = 0; i < 4; ++i) {
    if (!sides[i].seen || sides[i].curve.size() < 2) return std::nullopt;
    Eigen::Matrix<double, 2, 6> j;
    Eigen::Vector2d residual, by_m;
    for (int end = 0; end < 2; ++end) {
      const auto there = EndOf(camera, sides[i], end == 1);
      if (!there) return std::nullopt;
      const Beside beside = BesideOf(*there, pose, corners[i], corners[(i + 1) % 4]);
      residual[end] = beside.px;
      by_m[end] = beside.by_m;
      j.row(end) = beside.by_delta;
    }
    const Eigen::Matrix2d covariance =
        sides[i].covariance +
        Eigen::Matrix2d((place_sigma_m * by_m).array().square().matrix().asDiagonal());
    normal.covariance[i] = covariance;
    const auto inverse = InverseOfPositive(covariance);
    if (!inverse || !residual.allFinite()) return std::nullopt;
    const Eigen::Matrix2d information = *inverse;
    normal.h += j.transpose() * information * j;
    normal.g -= j.transpose() * information * residual;
    normal.chi2 += residual.dot(information * residual);
  }
  return normal;
}

}  // namespace

std::optional<OutlinePose> PoseFromSides(const Camera& camera, const Target& target,
                                         const std::array<ImageSide, 4>& sides, const Rigid3& start,
                                         double place_sigma_m) {
  constexpr int kIterations = 30;
  Rigid3 pose = start;
  auto here = NormalEquations(camera, target, sides, pose, place_sigma_m);
  double damping = 1e-4;
  for (int i = 0; here && i < kIterations; ++i) {
    Matrix6d damped = here->h;
    damped.diagonal() *= 1 + damping;
    const Vector6d step = SolveSymmetric(damped, here->g);
    if (!step.allFinite() || step.norm() > 1e3) return std::nullopt;
    const Rigid3 next = Exp(step) * pose;
    auto there = NormalEquations(camera, target, sides, next, place_sigma_m);
    if (!there || !(there->chi2 <= here->chi2)) {
      damping *= 10;
      if (damping > 1e8) break;
      continue;
    }
    const bool done = here->chi2 - there->chi2 < 1e-9 * (1 + here->chi2);
    pose = next;
    here = std::move(there);
    damping *= 0.1;
    if (done) break;
  }
  if (!here) return std::nullopt;
  const auto covariance = InverseOfPositive(here->h);
  if (!covariance || !covariance->allFinite()) return std::nullopt;
  OutlinePose out;
  out.side_covariance = here->covariance;
  out.pose.sensor_from_target = pose;
  out.pose.covariance = 0.5 * (*covariance + covariance->transpose());
  out.chi2 = here->chi2;
  return out;
}

}  // namespace rgbdt
