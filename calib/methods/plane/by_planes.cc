#include "calib/methods/plane/by_planes.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calib/model/linear_algebra.h"
#include "calib/solve/calibrate_alone.h"

namespace rgbdt {
namespace {

struct Sums {
  Matrix6d h = Matrix6d::Zero();
  Vector6d g = Vector6d::Zero();
  double squares = 0, points = 0;
};

// All points of a board at once: n . (camera_from_lidar p - t) = x . (p - centre, 1).
void Add(const CameraView& o, const Rigid3& camera_from_lidar, Sums* sums) {
  const Rigid3& board = o.image->pose->sensor_from_target;
  const Eigen::Vector3d n = board.rotation * Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d centre = camera_from_lidar * o.cloud->centre;
  const Eigen::Matrix3d turn_back = camera_from_lidar.rotation.toRotationMatrix().transpose();
  Eigen::Vector4d x;
  x << turn_back * n, n.dot(centre - board.translation);
  // A turn w of the camera moves R p by w x R p, so n . (w x R p) = (R' (n x w)) . p.
  Eigen::Matrix<double, 4, 6> j = Eigen::Matrix<double, 4, 6>::Zero();
  j.topLeftCorner<3, 3>() = turn_back * CrossMatrix(n);
  j.block<1, 3>(3, 0) = centre.cross(n).transpose();
  j.block<1, 3>(3, 3) = n.transpose();
  sums->h += j.transpose() * o.cloud->raw_scatter * j;
  sums->g -= j.transpose() * o.cloud->raw_scatter * x;
  sums->squares += x.dot(o.cloud->raw_scatter * x);
  sums->points += o.cloud->raw_scatter(3, 3);
}

Sums SumsAt(const std::vector<const CameraView*>& used, const Rigid3& camera_from_lidar) {
  Sums sums;
  for (const CameraView* o : used) Add(*o, camera_from_lidar, &sums);
  return sums;
}

// The steps of Gauss and Newton; where one would let the squares grow, as it may far from the
// solution, damped after Levenberg and Marquardt until it does not.
class Steps {
 public:
  Vector6d From(const std::vector<const CameraView*>& used, const Rigid3& pose) {
    constexpr double kLeast = 1e-6;
    constexpr double kMost = 1e6;
    constexpr double kShort = 1e-4;  // rounding could ask for damping below
    const Sums sums = SumsAt(used, pose);
    Vector6d step = Damped(sums);
    while (step.norm() > kShort && damping_ < kMost &&
           SumsAt(used, Exp(step) * pose).squares > sums.squares) {
      damping_ = std::max(kLeast, 10 * damping_);
      step = Damped(sums);
    }
    damping_ = damping_ > kLeast ? damping_ / 10 : 0;
    return step;
  }

 private:
  Vector6d Damped(const Sums& sums) const {
    Matrix6d h = sums.h;
    h.diagonal() *= 1 + damping_;
    return SolveSymmetric(h, sums.g);
  }

  double damping_ = 0;
};

}  // namespace

CameraCalibration SolvePlanes(const std::vector<const CameraView*>& used, const Rigid3& start) {
  constexpr int kIterations = 200;
  CameraCalibration result;
  result.camera_from_lidar = start;
  bool converged = false;
  Steps steps;
  for (int i = 0; i < kIterations && !converged; ++i) {
    const Vector6d step = steps.From(used, result.camera_from_lidar);
    if (!step.allFinite()) break;
    result.camera_from_lidar = Exp(step) * result.camera_from_lidar;
    converged = step.norm() < 1e-10;
  }
  const Sums sums = SumsAt(used, result.camera_from_lidar);
  const Vector6d eigenvalues = EigensystemOf(sums.h).values;
  if (!converged || !(eigenvalues[0] > 1e-9 * eigenvalues[5])) {
    result.status = SolveStatus::kDegenerate;
    result.detail = "the boards' planes leave the pose loose; tilt the board otherwise";
    return result;
  }
  result.status = SolveStatus::kConverged;
  const double variance = sums.squares / std::max(1.0, sums.points - 6);
  const Matrix6d inverse = InverseOfSymmetric(sums.h);
  result.covariance = 0.5 * variance * (inverse + inverse.transpose());
  return result;
}

CalibratedCameras CalibrateByPlanes(const Target& target, const CalibrateOptions& options,
                                    std::vector<CameraViews> cameras) {
  return CalibrateAlone(
      target, options, std::move(cameras),
      [](CameraViews* views, const Rigid3& guess) { return SolvePlanes(views->Used(), guess); });
}

}  // namespace rgbdt
