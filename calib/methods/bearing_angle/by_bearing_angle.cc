#include "calib/methods/bearing_angle/by_bearing_angle.h"

#include <cmath>
#include <optional>
#include <utility>

#include "calib/camera/camera.h"
#include "calib/camera/pixel_by_point.h"
#include "calib/methods/bearing_angle/angle_pose.h"
#include "calib/model/check.h"
#include "calib/model/linear_algebra.h"
#include "calib/model/text.h"
#include "calib/solve/calibrate_alone.h"
#include "calib/solve/first_guess.h"

namespace rgbdt {
namespace {

using Picks = std::vector<CornerPick>;

std::optional<Rigid3> LinearPose(const Camera& camera, const Picks& picks, std::size_t most) {
  std::vector<Eigen::Vector3d> points;
  std::vector<Eigen::Vector3d> directions;
  const std::size_t count = std::min(most, picks.size());
  for (std::size_t i = 0; i < count; ++i) {
    const CornerPick& pick = picks[i * picks.size() / count];
    const auto direction = camera.Unproject(pick.pixel);
    if (!direction) continue;
    points.push_back(pick.point);
    directions.push_back(*direction);
  }
  return PoseFromAngles(points, directions);
}

struct Sums {
  Matrix6d h = Matrix6d::Zero();
  Vector6d g = Vector6d::Zero();
  double squares = 0;   // [px^2]
  double spacings = 0;  // the same, each over its beams' spacing in the image
  bool all_seen = true;
};

Sums SumsAt(const Camera& camera, const Picks& picks, const Rigid3& camera_from_lidar) {
  Sums sums;
  for (const CornerPick& pick : picks) {
    const Eigen::Vector3d p = camera_from_lidar * pick.point;
    const auto pixel = camera.Project(p);
    if (!pixel) {
      sums.all_seen = false;
      continue;
    }
    const Eigen::Vector2d off = pick.pixel - *pixel;
    Eigen::Matrix<double, 3, 6> by_delta;
    by_delta << -CrossMatrix(p), Eigen::Matrix3d::Identity();
    const Eigen::Matrix<double, 2, 3> by_point = PixelByPoint(camera.lens(), p);
    const Eigen::Matrix<double, 2, 6> j = by_point * by_delta;
    sums.h += j.transpose() * j;
    sums.g += j.transpose() * off;
    sums.squares += off.squaredNorm();
    const double spacing_px = by_point.norm() / std::sqrt(2.0) * pick.spacing_m;
    sums.spacings += std::pow(off.norm() / std::max(1.0, spacing_px), 2);
  }
  return sums;
}

// Gauss and Newton's step, halved until the squares fall.
std::optional<Rigid3> Stepped(const Camera& camera, const Picks& picks, const Rigid3& pose,
                              double squares, Vector6d step) {
  constexpr int kHalvings = 10;
  for (int i = 0; i < kHalvings; ++i) {
    const Rigid3 next = Exp(step) * pose;
    const Sums there = SumsAt(camera, picks, next);
    if (there.all_seen && there.squares <= squares) return next;
    step /= 2;
  }
  return std::nullopt;
}

// Where squared pixels are least; nothing where no end is found.
std::optional<Rigid3> Refined(const Camera& camera, const Picks& picks, Rigid3 pose) {
  constexpr int kIterations = 100;
  constexpr double kAtRest = 1e-8;
  for (int i = 0; i < kIterations; ++i) {
    const Sums sums = SumsAt(camera, picks, pose);
    if (!sums.all_seen) return std::nullopt;
    const Vector6d step = SolveSymmetric(sums.h, sums.g);
    if (!step.allFinite()) return std::nullopt;
    if (step.norm() < kAtRest) return Exp(step) * pose;
    const auto next = Stepped(camera, picks, pose, sums.squares, step);
    if (!next) return pose;
    pose = *next;
  }
  return std::nullopt;
}

CameraCalibration Failed(SolveStatus status, std::string why, const Rigid3& pose = {}) {
  CameraCalibration calibration;
  calibration.camera_from_lidar = pose;
  calibration.status = status;
  calibration.detail = std::move(why);
  return calibration;
}

}  // namespace

void BearingAngleOptions::Check() const {
  const OptionCheck check("bearing angle");
  check.AtLeast(static_cast<int>(least_points), 5, "least_points");
  check.AtLeast(static_cast<int>(most_linear), 5, "most_linear");
  check.Positive(most_spacings, "most_spacings");
}

Picks CornerPicks(const std::vector<const CameraView*>& used, const Rigid3& guess) {
  Picks picks;
  for (const CameraView* view : used) {
    if (view->cloud->corners.size() != 4 || !view->image->pose || !view->cloud->pose) continue;
    const TargetPose& in_image = *view->image->pose;
    const Rigid3 by_cloud = guess * view->cloud->pose->sensor_from_target;
    const std::size_t turned = HalfTurned(by_cloud, in_image) ? 2 : 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const Eigen::Vector3d& point = view->cloud->corners[(k + turned) % 4];
      const Eigen::Vector2d& pixel = view->image->outline_corners[k];
      if (point.allFinite() && pixel.allFinite()) {
        picks.push_back({point, pixel, view->cloud->spacing_m});
      }
    }
  }
  return picks;
}

CameraCalibration SolveCornerPicks(const CameraSpec& spec, const Picks& picks,
                                   const BearingAngleOptions& options) {
  options.Check();
  const Camera camera(spec);
  if (picks.size() < options.least_points) {
    return Failed(SolveStatus::kNotSolved,
                  Format("%zu outline corners are seen in image and cloud; %zu are needed",
                         picks.size(), options.least_points));
  }
  const auto start = LinearPose(camera, picks, options.most_linear);
  if (!start) {
    return Failed(SolveStatus::kNotSolved, "the outline corners do not tell a linear pose");
  }
  const auto pose = Refined(camera, picks, *start);
  if (!pose) {
    return Failed(SolveStatus::kNotConverged, "from the linear pose the refinement comes to no end",
                  *start);
  }
  const Sums sums = SumsAt(camera, picks, *pose);
  const auto count = static_cast<double>(picks.size());
  const double spacings = std::sqrt(sums.spacings / count);
  if (spacings > options.most_spacings) {
    return Failed(
        SolveStatus::kNotConverged,
        Format("corners lie %.1f beams' spacings apart in image and cloud (RMS)", spacings), *pose);
  }
  const Vector6d eigenvalues = EigensystemOf(sums.h).values;
  if (!(eigenvalues[0] > 1e-9 * eigenvalues[5])) {
    return Failed(SolveStatus::kDegenerate, "the outline corners leave the pose loose", *pose);
  }
  CameraCalibration result;
  result.camera_from_lidar = *pose;
  result.status = SolveStatus::kConverged;
  const Matrix6d inverse = InverseOfSymmetric(sums.h);
  result.covariance = 0.5 * sums.squares / (2 * count - 6) * (inverse + inverse.transpose());
  return result;
}

CalibratedCameras CalibrateByBearingAngle(const Target& target, const CalibrateOptions& options,
                                          std::vector<CameraViews> cameras) {
  return CalibrateAlone(
      target, options, std::move(cameras), [](CameraViews* views, const Rigid3& guess) {
        CameraCalibration found = SolveCornerPicks(*views->spec, CornerPicks(views->Used(), guess));
        if (!found.solved()) {
          found.camera_from_lidar = views->report.calibration.camera_from_lidar;
        }
        return found;
      });
}

}  // namespace rgbdt
