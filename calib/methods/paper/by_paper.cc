#include "calib/methods/paper/by_paper.h"

#include <ceres/manifold.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <cmath>
#include <memory>
#include <utility>

#include "calib/camera/camera.h"
#include "calib/methods/paper/internal/paper_cost.h"
#include "calib/model/stopwatch.h"
#include "calib/solve/evaluate.h"

namespace rgbdt {
namespace {

using Views = std::vector<const CameraView*>;

// Share of points in the image below which the paper saw no convergence (section III).
constexpr double kMinShareInImage = 0.5;

// Share of the views' boundary points that fall into the image: elsewhere the paper's objective is
// flat.
double ShareInImage(const Camera& camera, const Views& views, const Rigid3& camera_from_lidar) {
  double inside = 0;
  double all = 0;
  for (const CameraView* o : views) {
    for (const Eigen::Vector3d& point : o->cloud->boundary) {
      const auto pixel = camera.Project(camera_from_lidar * point);
      inside += pixel && camera.Contains(*pixel) ? 1 : 0;
      all += 1;
    }
  }
  return all > 0 ? inside / all : 0;
}

StartResult FromWideStart(const CameraSpec& camera, const Views& used, const Rigid3& guess,
                          const CameraReport& report, const CalibrateOptions& options) {
  StartResult result;
  const auto degrees = [](double rad) { return std::to_string(std::lround(rad * 180 / M_PI)); };
  result.start = degrees(options.wide_roll_rad) + " deg roll and " + degrees(options.wide_yaw_rad) +
                 " deg yaw off the hand-measured guess";
  result.calibration = SolvePaper(
      camera, used, TurnedStart(guess, options.wide_roll_rad, options.wide_yaw_rad), options);
  CameraReport judged;
  judged.calibration = result.calibration;
  judged = JudgeCamera(camera, used, std::move(judged));
  result.distance_transform_px = judged.distance_transform_px.train;
  result.from_result =
      ErrorOf(result.calibration.camera_from_lidar, report.calibration.camera_from_lidar);
  return result;
}

}  // namespace

Rigid3 TurnedStart(const Rigid3& camera_from_lidar, double roll_rad, double yaw_rad) {
  return camera_from_lidar * RotationAbout(Eigen::Vector3d::UnitZ(), yaw_rad) *
         RotationAbout(Eigen::Vector3d::UnitX(), roll_rad);
}

CameraCalibration SolvePaper(const CameraSpec& spec, const Views& used, const Rigid3& start,
                             const CalibrateOptions& options) {
  const Camera camera(spec);
  const FieldBeyond beyond =
      options.smooth_field ? FieldBeyond::kSmooth : FieldBeyond::kBorderValue;
  std::vector<std::unique_ptr<DistanceField>> fields;
  ceres::Problem problem;
  Vector6d delta = Vector6d::Zero();
  for (const CameraView* o : used) {
    fields.push_back(std::make_unique<DistanceField>(o->image->width, o->image->height,
                                                     o->image->edge_pixels, beyond));
    problem.AddResidualBlock(
        PaperCost::Create(&camera, fields.back().get(), &o->cloud->boundary, start).release(),
        nullptr, delta.data());
  }
  ceres::Solver::Options solver;
  // The field is a patchwork of surfaces: a few steps uphill are allowed, to leave its small dents.
  solver.use_nonmonotonic_steps = true;
  solver.minimizer_type = ceres::TRUST_REGION;
  solver.trust_region_strategy_type = ceres::LEVENBERG_MARQUARDT;
  solver.linear_solver_type = ceres::DENSE_QR;
  solver.max_num_iterations = options.max_iterations;
  solver.num_threads = 1;  // the same input gives the same bits; the look-up tables are shared
  solver.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  // Rotation first: from 30 degrees away, with half of the points outside the images, a free
  // translation runs off by metres before the rotation has come round.
  problem.SetManifold(delta.data(), new ceres::SubsetManifold(6, {3, 4, 5}));
  ceres::Solve(solver, &problem, &summary);
  problem.SetManifold(delta.data(), nullptr);
  ceres::Solve(solver, &problem, &summary);

  CameraCalibration result;
  result.camera = spec.name;
  result.camera_from_lidar = Exp(delta) * start;
  const bool converged = summary.termination_type == ceres::CONVERGENCE;
  result.status = converged ? SolveStatus::kConverged : SolveStatus::kNotConverged;
  if (!converged) result.detail = summary.message;
  // Where most points miss the image the gradient vanishes, which Ceres takes for a minimum; not so
  // where the field goes on.
  const double share = ShareInImage(camera, used, result.camera_from_lidar);
  if (!options.smooth_field && share < kMinShareInImage) {
    result.status = SolveStatus::kNotConverged;
    result.detail = "only " + std::to_string(std::lround(100 * share)) +
                    "% of the boundary points project into the image; start nearer";
  }
  return result;
}

CameraReport CalibrateByPaper(const CalibrateOptions& options, const CameraViews& views) {
  const CameraSpec& camera = *views.spec;
  CameraReport report = views.report;
  const Rigid3 guess = camera.camera_from_lidar_guess.value_or(Rigid3());
  report.first_guess = guess;
  report.calibration.camera_from_lidar = guess;
  const Views used = views.Used();
  if (static_cast<int>(used.size()) < options.min_views) {
    report.calibration.detail =
        TooFewViews(used.size(), options) +
        (camera.camera_from_lidar_guess ? "; this is the hand-measured guess" : "");
    return report;
  }
  const Stopwatch watch;
  report.calibration = SolvePaper(camera, used, guess, options);
  report.solve_s = watch.Seconds();
  report = JudgeCamera(camera, views.Usable(), std::move(report));
  if (options.wide_start) {
    report.other_starts.push_back(FromWideStart(camera, used, guess, report, options));
  }
  return report;
}

}  // namespace rgbdt
