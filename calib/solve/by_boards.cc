#include "calib/solve/by_boards.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "calib/model/stopwatch.h"
#include "calib/solve/closure.h"
#include "calib/solve/colouring.h"
#include "calib/solve/evaluate.h"
#include "calib/solve/guess_cameras.h"
#include "calib/solve/internal/cross_check.h"
#include "calib/solve/internal/joint_solve.h"
#include "calib/solve/internal/next_view.h"

namespace rgbdt {
namespace {

using Views = std::vector<const Observation*>;

// Metres more along each boundary point's beam.
void AddToRanges(double offset_m, CloudEdges* cloud) {
  for (Eigen::Vector3d& p : cloud->boundary) p += offset_m * p.normalized();
}

void AddNuisance(const std::string& name, const std::string& unit, double scale, double value,
                 double variance, double prior_sigma, CameraReport* report) {
  const double sigma = std::sqrt(std::max(0.0, variance));
  if (sigma > 0.98 * prior_sigma) return;  // the data say nothing of it
  report->nuisance.push_back({name, unit, {scale * value, scale * sigma}});
}

void FillNuisances(const JointProblem& joint, const JointResult& result, CameraReport* report) {
  struct Line {
    SharedUnknown unknown;
    const char* name;
    const char* unit;
  };
  constexpr Line kLines[] = {{kNoReturnShift, "beam edge, nothing beyond", "mrad"},
                             {kFarShift, "beam edge, far background", "mrad"},
                             {kMergedShift, "beam edge, background just behind", "mrad"},
                             {kThickness, "board's thickness", "mm"},
                             {kOutlineTop, "board's top side, beyond its pattern", "mm"},
                             {kOutlineRight, "board's right side, beyond its pattern", "mm"},
                             {kOutlineBottom, "board's bottom side, beyond its pattern", "mm"},
                             {kOutlineLeft, "board's left side, beyond its pattern", "mm"},
                             {kRangeOffset, "range offset", "mm"}};
  const auto first = static_cast<Eigen::Index>(6 * joint.cameras.size());
  for (const Line& line : kLines) {
    AddNuisance(line.name, line.unit, 1000,
                result.solution.state.shared[static_cast<std::size_t>(line.unknown)],
                result.variance_factor *
                    result.solution.covariance(first + line.unknown, first + line.unknown),
                joint.problem.priors.Sigma(line.unknown), report);
  }
}

// How much single sides differ: the solve's own estimate, from so many sides.
void FillSideSpread(const JointProblem& joint, CameraReport* report) {
  double sides = 0;
  for (const BoardView& view : joint.problem.views) {
    sides += static_cast<double>(std::count(view.sides.begin(), view.sides.end(), true));
  }
  if (sides == 0) return;
  const double sigma = joint.problem.priors.side_sigma_rad;
  report->nuisance.push_back({"beam edge, scatter of single sides",
                              "mrad",
                              {1000 * sigma, 1000 * sigma / std::sqrt(2 * sides)}});
}

// The joint solve's result into the cameras' reports.
void TakeJoint(const CalibrateOptions& options, const JointProblem& joint,
               const JointResult& result) {
  for (std::size_t c = 0; c < joint.cameras.size(); ++c) {
    CameraReport& report = joint.cameras[c].views->report;
    const bool converged = result.solution.converged;
    report.calibration = {joint.cameras[c].views->spec->name,
                          result.solution.state.camera_from_lidar[c], CovarianceOf(result, c),
                          converged ? SolveStatus::kConverged : SolveStatus::kNotConverged,
                          converged ? "" : "the joint solve did not settle"};
    FillNuisances(joint, result, &report);
    FillSideSpread(joint, &report);
    if (!options.first_guess.range_offset) continue;
    const auto at = static_cast<Eigen::Index>(6 * joint.cameras.size()) + kRangeOffset;
    report.range_offset =
        Estimate{result.solution.state.shared[kRangeOffset],
                 std::sqrt(result.variance_factor * result.solution.covariance(at, at))};
  }
}

void ShiftRanges(const std::vector<GuessedCamera>& cameras) {
  for (const GuessedCamera& camera : cameras) {
    if (!camera.views->report.range_offset) continue;
    for (Observation& o : camera.views->all) {
      if (o.cloud) AddToRanges(camera.views->report.range_offset->value, &*o.cloud);
    }
  }
}

// Of cameras that are solved apart, the worst one's.
void TakeNextView(std::optional<NextView> next, Report* report) {
  if (!next) return;
  if (report->next_view && report->next_view->sigma_before_px >= next->sigma_before_px) return;
  report->next_view = std::move(next);
}

// Cameras that are solved together, from their guesses to their reports.
void SolveGroup(const Target& target, const CalibrateOptions& options,
                const std::vector<GuessedCamera>& cameras, Report* report) {
  const Stopwatch watch;
  JointProblem joint = MakeJointProblem(
      target, cameras,
      options.first_guess.range_offset ? options.first_guess.range_offset_sigma_m : 0);
  const JointResult result = SolveJointly(&joint);
  TakeJoint(options, joint, result);
  ShareTime(watch.Seconds(), cameras);
  if (options.diagnostics) {
    CrossValidate(joint, result, options.folds);
    TakeNextView(FindNextView(joint, result), report);
  }
  for (const GuessedCamera& camera : cameras) CheckDegenerate(camera.views);
  ShiftRanges(cameras);
  JudgeCameras({target, result.solution.state.shared, joint.problem.priors}, cameras);
}

}  // namespace

void CalibrateByBoards(const Target& target, const CalibrateOptions& options,
                       std::vector<CameraViews>* cameras, Report* report) {
  const std::vector<GuessedCamera> guessed = GuessCameras(options, cameras);
  if (options.joint && !guessed.empty()) {
    SolveGroup(target, options, guessed, report);
  } else {
    for (const GuessedCamera& camera : guessed) SolveGroup(target, options, {camera}, report);
  }
  if (options.diagnostics) report->closure = CloseLoops(guessed);
}

}  // namespace rgbdt
