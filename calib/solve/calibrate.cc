#include "calib/solve/calibrate.h"

#include <ceres/manifold.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <tuple>

#include "calib/model/errors.h"
#include "calib/solve/evaluate.h"
#include "calib/solve/paper_cost.h"

namespace rgbdt {
namespace {

using Views = std::vector<const Observation*>;

// Share of points in the image below which the paper saw no convergence (section III).
constexpr double kMinShareInImage = 0.5;

// One camera's observations in the order of their views, whatever order they came in.
std::vector<Observation> ObservationsOf(const std::string& camera,
                                        const std::vector<Observation>& observations) {
  std::vector<Observation> own;
  for (const Observation& o : observations) {
    if (o.camera == camera) own.push_back(o);
  }
  std::stable_sort(own.begin(), own.end(), [](const Observation& a, const Observation& b) {
    return std::tie(a.view, a.image_utime, a.seq) < std::tie(b.view, b.image_utime, b.seq);
  });
  return own;
}

Views PointersTo(const std::vector<Observation>& observations) {
  Views views;
  for (const Observation& o : observations) views.push_back(&o);
  return views;
}

// Why an observation cannot be used; empty: it can. What comes from the bus may be well formed and
// still hold nothing to solve with.
std::string WhyUnusable(const CameraSpec& camera, const Observation& o) {
  if (!o.rejected.empty()) return o.rejected;
  if (!o.image || o.image->edge_pixels.empty() || o.image->outline.empty()) {
    return "the observation has no edges in the image";
  }
  if (!o.cloud || o.cloud->boundary.empty()) {
    return "the observation has no boundary points in the cloud";
  }
  if (o.image->width != camera.width || o.image->height != camera.height) {
    return "the observation's image is " + std::to_string(o.image->width) + "x" +
           std::to_string(o.image->height) + ", the rig file says " + std::to_string(camera.width) +
           "x" + std::to_string(camera.height);
  }
  return "";
}

Views Usable(const CameraSpec& camera, const Views& views) {
  Views usable;
  for (const Observation* o : views) {
    if (WhyUnusable(camera, *o).empty()) usable.push_back(o);
  }
  return usable;
}

Views Used(const CameraSpec& camera, const Views& views) {
  Views used = Usable(camera, views);
  used.erase(std::remove_if(used.begin(), used.end(), [](auto* o) { return o->heldout; }),
             used.end());
  return used;
}

// Views, rejections and computing time: what a report says whatever the method.
void Describe(const CameraSpec& camera, const Views& views, CameraReport* report) {
  for (const Observation* o : views) {
    report->detect_image_s += o->detect_image_s;
    report->detect_cloud_s += o->detect_cloud_s;
    const std::string why = WhyUnusable(camera, *o);
    if (!why.empty()) {
      report->rejected.push_back({o->view, why});
    } else {
      (o->heldout ? report->heldout : report->used).push_back(o->view);
    }
  }
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
  JudgeCamera(camera, used, &judged);
  result.distance_transform_px = judged.distance_transform_px.train;
  result.from_result =
      ErrorOf(result.calibration.camera_from_lidar, report.calibration.camera_from_lidar);
  return result;
}

std::string TooFewViews(std::size_t usable, const CalibrateOptions& options) {
  return "not calibrated: " + std::to_string(usable) + " usable views, at least " +
         std::to_string(options.min_views) + " are needed";
}

// Metres more along each boundary point's beam.
void AddToRanges(double offset_m, CloudEdges* cloud) {
  for (Eigen::Vector3d& p : cloud->boundary) p += offset_m * p.normalized();
}

// From the hand-measured guess, by the paper's solve. False: there is none, the status says why.
bool CalibrateByPaper(const CameraSpec& camera, const Views& views, const CalibrateOptions& options,
                      CameraReport* report) {
  const Rigid3 guess = camera.camera_from_lidar_guess.value_or(Rigid3());
  report->first_guess = guess;
  report->calibration.camera_from_lidar = guess;
  const Views used = Used(camera, views);
  if (static_cast<int>(used.size()) < options.min_views) {
    report->calibration.status =
        TooFewViews(used.size(), options) +
        (camera.camera_from_lidar_guess ? "; this is the hand-measured guess" : "");
    return false;
  }
  report->calibration = SolvePaper(camera, used, guess, options);
  return true;
}

// From the boards of the views used; false as above. The views held out have no say, but they
// choose their board by the result, too.
bool CalibrateByBoards(const CameraSpec& camera, const CalibrateOptions& options,
                       std::vector<Observation>* own, CameraReport* report) {
  Views used = Used(camera, PointersTo(*own));
  if (static_cast<int>(used.size()) < options.min_views) {
    report->calibration.status = TooFewViews(used.size(), options);
    return false;
  }
  const FirstGuess guess = GuessFromBoards(used, options.first_guess);
  if (!guess.camera_from_lidar) {
    report->calibration.status = "not calibrated: " + guess.status;
    return false;
  }
  report->first_guess = guess.camera_from_lidar;
  for (Observation& o : *own) {
    o = WithChosenCandidate(std::move(o), *guess.camera_from_lidar);
    if (o.cloud) AddToRanges(guess.range_offset_m, &*o.cloud);
  }
  used = Used(camera, PointersTo(*own));
  if (static_cast<int>(used.size()) < options.min_views) {
    report->calibration.status = TooFewViews(used.size(), options);
    return false;
  }
  report->calibration = {camera.name, *guess.camera_from_lidar, guess.covariance, true,
                         "converged"};
  if (options.first_guess.range_offset) {
    report->range_offset = Estimate{guess.range_offset_m, guess.range_offset_sigma_m};
  }
  return true;
}

CameraReport CalibrateCamera(const CameraSpec& camera, std::vector<Observation>* own,
                             const CalibrateOptions& options) {
  const bool by_paper = options.method == kPaperMethod;
  CameraReport report;
  report.calibration.camera = camera.name;
  const auto begin = std::chrono::steady_clock::now();
  const bool solved = by_paper ? CalibrateByPaper(camera, PointersTo(*own), options, &report)
                               : CalibrateByBoards(camera, options, own, &report);
  report.solve_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const Views views = PointersTo(*own);
  Describe(camera, views, &report);
  if (!solved) return report;
  JudgeCamera(camera, Usable(camera, views), &report);
  if (by_paper && options.wide_start) {
    report.other_starts.push_back(
        FromWideStart(camera, Used(camera, views), *report.first_guess, report, options));
  }
  return report;
}

// Share of the views' boundary points that fall into the image: elsewhere the objective is flat.
double ShareInImage(const Camera& camera, const Views& views, const Rigid3& camera_from_lidar) {
  double inside = 0;
  double all = 0;
  for (const Observation* o : views) {
    for (const Eigen::Vector3d& point : o->cloud->boundary) {
      const auto pixel = camera.Project(camera_from_lidar * point);
      inside += pixel && camera.Contains(*pixel) ? 1 : 0;
      all += 1;
    }
  }
  return all > 0 ? inside / all : 0;
}

}  // namespace

void CalibrateOptions::Check() const {
  RequireMethod(method);
  first_guess.Check();
  if (min_views < 1) {
    throw InputError("CalibrateOptions.min_views is " + std::to_string(min_views) +
                     "; expected 1 or more");
  }
  if (max_iterations < 1) {
    throw InputError("CalibrateOptions.max_iterations is " + std::to_string(max_iterations) +
                     "; expected 1 or more");
  }
}

Rigid3 TurnedStart(const Rigid3& camera_from_lidar, double roll_rad, double yaw_rad) {
  return camera_from_lidar * RotationAbout(Eigen::Vector3d::UnitZ(), yaw_rad) *
         RotationAbout(Eigen::Vector3d::UnitX(), roll_rad);
}

CameraCalibration SolvePaper(const CameraSpec& spec, const Views& used, const Rigid3& start,
                             const CalibrateOptions& options) {
  const Camera camera(spec);
  std::vector<std::unique_ptr<DistanceField>> fields;
  ceres::Problem problem;
  Vector6d delta = Vector6d::Zero();
  for (const Observation* o : used) {
    fields.push_back(
        std::make_unique<DistanceField>(o->image->width, o->image->height, o->image->edge_pixels));
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
  result.converged = summary.termination_type == ceres::CONVERGENCE;
  result.status = result.converged ? "converged" : "not converged: " + summary.message;
  // Where most points miss the image the gradient vanishes, which Ceres takes for a minimum.
  const double share = ShareInImage(camera, used, result.camera_from_lidar);
  if (share < kMinShareInImage) {
    result.converged = false;
    result.status = "not converged: only " + std::to_string(std::lround(100 * share)) +
                    "% of the boundary points project into the image; start nearer";
  }
  return result;
}

Report Calibrate(const Rig& rig, const std::vector<Observation>& observations,
                 const CalibrateOptions& options) {
  options.Check();
  Report report;
  report.method = options.method;
  report.rig_hash = rig.hash;
  for (const CameraSpec& camera : rig.cameras) {
    std::vector<Observation> own = ObservationsOf(camera.name, observations);
    report.cameras.push_back(CalibrateCamera(camera, &own, options));
    for (const Observation* o : Usable(camera, PointersTo(own))) {
      report.utime = std::max(report.utime, o->image_utime);
    }
  }
  return report;
}

Report Evaluate(const Rig& rig, const std::vector<Observation>& observations,
                const Calibration& calibration) {
  Report report;
  report.method = calibration.method;
  report.rig_hash = rig.hash;
  report.utime = calibration.utime;
  for (const CameraSpec& camera : rig.cameras) {
    const CameraCalibration* found = calibration.Find(camera.name);
    if (found == nullptr) continue;
    std::vector<Observation> own = ObservationsOf(camera.name, observations);
    for (Observation& o : own) {
      o = WithChosenCandidate(std::move(o), found->camera_from_lidar, kJudgeGate);
    }
    const Views views = PointersTo(own);
    CameraReport judged;
    if (calibration.method == kPaperMethod) judged.first_guess = camera.camera_from_lidar_guess;
    judged.calibration = *found;
    Describe(camera, views, &judged);
    JudgeCamera(camera, Usable(camera, views), &judged);
    report.cameras.push_back(std::move(judged));
  }
  return report;
}

}  // namespace rgbdt
