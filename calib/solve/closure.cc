#include "calib/solve/closure.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "calib/model/linear_algebra.h"

namespace rgbdt {
namespace {

// What one view by itself says of a camera: its pose, the covariance of delta about it, and how
// much of that the camera and the cloud bring in.
struct Alone {
  Rigid3 camera_from_lidar;
  Matrix6d by_camera = Matrix6d::Zero(), by_cloud = Matrix6d::Zero();
  Matrix6d Covariance() const {
    // Nothing is exact: a tenth of a milliradian, a tenth of a millimetre.
    return by_camera + by_cloud + 1e-8 * Matrix6d::Identity();
  }
};

// Of the board's pose in the image.
Matrix6d ByImage(const CameraView& view) {
  return kCornerSigmaInflation * kCornerSigmaInflation * view.image->pose->covariance;
}

Alone FromOneView(const CameraView& view, const Rigid3& near) {
  const TargetPose& seen = *view.image->pose;
  const TargetPose& cloud = *view.cloud->pose;
  Rigid3 camera_from_target = seen.sensor_from_target;
  if (HalfTurned(near.Inverse() * camera_from_target, cloud)) {
    camera_from_target = camera_from_target * kHalfTurn;
  }
  Alone alone;
  alone.camera_from_lidar = camera_from_target * cloud.sensor_from_target.Inverse();
  const Matrix6d adjoint = Adjoint(near);
  alone.by_camera = ByImage(view);
  alone.by_cloud = adjoint * cloud.covariance * adjoint.transpose();
  return alone;
}

// A camera's pose as the mean of its views, weighed, and each view's weight in it.
struct Mean {
  Rigid3 camera_from_lidar;
  std::map<std::string, Matrix6d> weights;

  Matrix6d WeightOf(const std::string& view) const {
    const auto found = weights.find(view);
    return found == weights.end() ? Matrix6d(Matrix6d::Zero()) : found->second;
  }
};

Mean MeanOf(const GuessedCamera& camera) {
  Mean mean{*camera.guess.camera_from_lidar, {}};
  for (int round = 0; round < 3; ++round) {
    Matrix6d information = Matrix6d::Zero();
    Vector6d gradient = Vector6d::Zero();
    mean.weights.clear();
    for (const CameraView* o : camera.views.Used()) {
      const Alone alone = FromOneView(*o, mean.camera_from_lidar);
      const Matrix6d weight = InverseOfSymmetric(Matrix6d(alone.Covariance()));
      information += weight;
      gradient += weight * Log(alone.camera_from_lidar * mean.camera_from_lidar.Inverse());
      mean.weights[o->view] = weight;
    }
    for (auto& [view, weight] : mean.weights) weight = SolveSymmetric(information, weight);
    mean.camera_from_lidar = Exp(SolveSymmetric(information, gradient)) * mean.camera_from_lidar;
  }
  return mean;
}

// Relative pose from one view's images; they may be told from opposite ends of the board.
Rigid3 ByImages(const CameraView& a, const CameraView& b, const Rigid3& near) {
  const Rigid3 straight =
      b.image->pose->sensor_from_target * a.image->pose->sensor_from_target.Inverse();
  const Rigid3 turned =
      b.image->pose->sensor_from_target * kHalfTurn * a.image->pose->sensor_from_target.Inverse();
  return RotationDistance(turned, near) < RotationDistance(straight, near) ? turned : straight;
}

// The pair by stereo: the mean over the views that both see, robust, and each view's weight in it.
Mean StereoOf(const GuessedCamera& a, const GuessedCamera& b, const Rigid3& b_from_a) {
  const Matrix6d b_by_a = Adjoint(b_from_a);
  Mean stereo{b_from_a, {}};
  for (int round = 0; round < 3; ++round) {
    Matrix6d information = Matrix6d::Zero();
    Vector6d gradient = Vector6d::Zero();
    stereo.weights.clear();
    for (const CameraView* in_a : a.views.Used()) {
      const CameraView* in_b = b.views.Find(in_a->view);
      if (in_b == nullptr) continue;
      const Matrix6d covariance = ByImage(*in_b) + b_by_a * ByImage(*in_a) * b_by_a.transpose() +
                                  1e-10 * Matrix6d::Identity();
      const Vector6d off = Log(ByImages(*in_a, *in_b, stereo.camera_from_lidar) *
                               stereo.camera_from_lidar.Inverse());
      const Matrix6d weight = InverseOfSymmetric(covariance);
      const double robust = std::min(1.0, 25 / std::max(1e-12, off.dot(weight * off)));
      information += robust * weight;
      gradient += robust * weight * off;
      stereo.weights[in_a->view] = robust * weight;
    }
    if (stereo.weights.empty()) break;
    for (auto& [view, weight] : stereo.weights) weight = SolveSymmetric(information, weight);
    stereo.camera_from_lidar =
        Exp(SolveSymmetric(information, gradient)) * stereo.camera_from_lidar;
  }
  return stereo;
}

// The covariance of the difference, which is a sum over the views' errors: of image a, of image b,
// of the cloud.
Matrix6d CovarianceOfDifference(const GuessedCamera& a, const GuessedCamera& b, const Mean& mean_a,
                                const Mean& mean_b, const Mean& stereo, const Matrix6d& b_by_a) {
  Matrix6d covariance = Matrix6d::Zero();
  const auto add = [&](const Matrix6d& by, const Matrix6d& of) {
    covariance += by * of * by.transpose();
  };
  std::set<std::string> views;
  for (const auto& [view, weight] : mean_a.weights) views.insert(view);
  for (const auto& [view, weight] : mean_b.weights) views.insert(view);
  for (const std::string& view : views) {
    const CameraView* in_a = a.views.Find(view);
    const CameraView* in_b = b.views.Find(view);
    const Matrix6d by_stereo = stereo.WeightOf(view);
    const Matrix6d by_a = b_by_a * mean_a.WeightOf(view);  // zero where the camera has not the view
    const Matrix6d by_b = mean_b.WeightOf(view);
    if (in_a != nullptr) add(by_a - by_stereo * b_by_a, ByImage(*in_a));
    if (in_b != nullptr) add(by_b - by_stereo, ByImage(*in_b));
    add(by_b * Adjoint(mean_b.camera_from_lidar) - by_a * Adjoint(mean_a.camera_from_lidar),
        (in_a != nullptr ? in_a : in_b)->cloud->pose->covariance);
  }
  return covariance;
}

std::optional<Closure> CloseLoop(const GuessedCamera& a, const GuessedCamera& b) {
  if (!a.guess.camera_from_lidar || !b.guess.camera_from_lidar) return std::nullopt;
  const Mean mean_a = MeanOf(a);
  const Mean mean_b = MeanOf(b);
  Closure closure;
  closure.from = a.views.spec->name;
  closure.to = b.views.spec->name;
  closure.by_lidar = mean_b.camera_from_lidar * mean_a.camera_from_lidar.Inverse();
  const Mean stereo = StereoOf(a, b, closure.by_lidar);
  if (stereo.weights.size() < 3) return std::nullopt;
  closure.by_images = stereo.camera_from_lidar;
  closure.difference = ErrorOf(closure.by_images, closure.by_lidar);
  const Matrix6d covariance =
      CovarianceOfDifference(a, b, mean_a, mean_b, stereo, Adjoint(closure.by_lidar));
  closure.sigma = {std::sqrt(covariance.topLeftCorner<3, 3>().trace()) * 180 / M_PI,
                   std::sqrt(covariance.bottomRightCorner<3, 3>().trace()) * 1000};
  const Vector6d delta = Log(closure.by_images * closure.by_lidar.Inverse());
  closure.chi2 = delta.dot(SolveSymmetric(covariance, delta));
  return closure;
}

}  // namespace

std::vector<Closure> CloseLoops(const std::vector<GuessedCamera>& cameras) {
  std::vector<Closure> loops;
  for (std::size_t a = 0; a < cameras.size(); ++a) {
    for (std::size_t b = a + 1; b < cameras.size(); ++b) {
      const auto loop = CloseLoop(cameras[a], cameras[b]);
      if (loop) loops.push_back(*loop);
    }
  }
  return loops;
}

}  // namespace rgbdt
