#include "calib/solve/by_boards.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "calib/model/stopwatch.h"
#include "calib/solve/closure.h"
#include "calib/solve/colouring.h"
#include "calib/solve/evaluate.h"
#include "calib/solve/internal/cross_check.h"
#include "calib/solve/internal/joint_solve.h"
#include "calib/solve/internal/next_view.h"

namespace rgbdt {
namespace {

struct NuisanceLine {
  SharedUnknown unknown;
  const char* name;
  const char* unit;  // of a thousandth of the unknown's own
};
constexpr NuisanceLine kNuisances[] = {
    {kNoReturnShift, "beam edge, nothing beyond", "mrad"},
    {kFarShift, "beam edge, far background", "mrad"},
    {kMergedShift, "beam edge, background just behind", "mrad"},
    {kThickness, "board's thickness", "mm"},
    {kOutlineTop, "board's top side, beyond its pattern", "mm"},
    {kOutlineRight, "board's right side, beyond its pattern", "mm"},
    {kOutlineBottom, "board's bottom side, beyond its pattern", "mm"},
    {kOutlineLeft, "board's left side, beyond its pattern", "mm"},
    {kRangeOffset, "range offset", "mm"}};

// An unknown that all views share, with its sigma, the variance factor counted in.
Estimate EstimateOf(const JointResult& result, SharedUnknown unknown) {
  const auto at = result.solution.covariance.rows() - kSharedUnknowns + unknown;
  return {result.solution.state.shared[static_cast<std::size_t>(unknown)],
          std::sqrt(std::max(0.0, result.variance_factor * result.solution.covariance(at, at)))};
}

// How much single sides differ, which no class explains: the solve's own estimate, from so many
// sides.
std::optional<Nuisance> SideScatter(const JointProblem& joint) {
  double sides = 0;
  for (const BoardView& view : joint.problem.views) {
    sides += static_cast<double>(std::count(view.sides.begin(), view.sides.end(), true));
  }
  if (sides == 0) return std::nullopt;
  const double sigma = joint.problem.priors.side_sigma_rad;
  return Nuisance{"beam edge, scatter of single sides",
                  "mrad",
                  {1000 * sigma, 1000 * sigma / std::sqrt(2 * sides)}};
}

std::vector<Nuisance> NuisancesOf(const JointResult& result) {
  std::vector<Nuisance> nuisances;
  for (const NuisanceLine& line : kNuisances) {
    const Estimate estimate = EstimateOf(result, line.unknown);
    // Where the prior's sigma is left, the data say nothing of it.
    if (estimate.sigma > 0.98 * result.joint.problem.priors.Sigma(line.unknown)) continue;
    nuisances.push_back({line.name, line.unit, {1000 * estimate.value, 1000 * estimate.sigma}});
  }
  if (auto scatter = SideScatter(result.joint)) nuisances.push_back(*scatter);
  return nuisances;
}

CameraCalibration CalibrationOf(const JointResult& result, std::size_t camera) {
  const bool converged = result.solution.converged;
  return {result.joint.cameras[camera].views->spec->name,
          result.solution.state.camera_from_lidar[camera], CovarianceOf(result, camera),
          converged ? SolveStatus::kConverged : SolveStatus::kNotConverged,
          converged ? "" : "the joint solve did not settle"};
}

// The joint solve's result into the cameras' reports.
void FillReports(const CalibrateOptions& options, const JointResult& result) {
  for (std::size_t c = 0; c < result.joint.cameras.size(); ++c) {
    CameraReport& report = result.joint.cameras[c].views->report;
    report.calibration = CalibrationOf(result, c);
    report.nuisance = NuisancesOf(result);
    if (options.first_guess.range_offset) report.range_offset = EstimateOf(result, kRangeOffset);
  }
}

EdgeModel EdgesOf(const JointResult& result) {
  const BoardProblem& problem = result.joint.problem;
  return {problem.target, result.solution.state.shared, problem.priors};
}

// Metres more along each boundary point's beam, where the ranges were found to be off.
void ShiftRanges(const std::vector<GuessedCamera>& cameras) {
  for (const GuessedCamera& camera : cameras) {
    if (!camera.views->report.range_offset) continue;
    const double offset_m = camera.views->report.range_offset->value;
    for (CameraView& view : camera.views->all) {
      if (!view.cloud) continue;
      for (Eigen::Vector3d& p : view.cloud->boundary) p += offset_m * p.normalized();
    }
  }
}

double RangeOffsetPrior(const CalibrateOptions& options) {
  return options.first_guess.range_offset ? options.first_guess.range_offset_sigma_m : 0;
}

void MarkDegenerate(const std::vector<GuessedCamera>& cameras) {
  for (const GuessedCamera& camera : cameras) {
    camera.views->report.calibration = WithDegeneracy(*camera.views);
  }
}

// Cameras that are solved together, from their guesses to their reports; returns where to hold the
// board next.
std::optional<NextView> SolveGroup(const Target& target, const CalibrateOptions& options,
                                   const std::vector<GuessedCamera>& cameras) {
  const Stopwatch watch;
  const JointResult result =
      SolveJointly(MakeJointProblem(target, cameras, RangeOffsetPrior(options)));
  FillReports(options, result);
  ShareTime(watch.Seconds(), cameras);
  if (options.diagnostics) CrossValidate(result, options.folds);
  auto next_view = options.diagnostics ? FindNextView(result) : std::nullopt;
  MarkDegenerate(cameras);
  ShiftRanges(cameras);
  JudgeCameras(EdgesOf(result), cameras);
  return next_view;
}

// All cameras at once, or each by itself.
std::vector<std::vector<GuessedCamera>> GroupsOf(const std::vector<GuessedCamera>& cameras,
                                                 bool joint) {
  std::vector<std::vector<GuessedCamera>> groups;
  if (joint && !cameras.empty()) groups.push_back(cameras);
  if (!joint) {
    for (const GuessedCamera& camera : cameras) groups.push_back({camera});
  }
  return groups;
}

// Of cameras that are solved apart, the worst one's.
std::optional<NextView> Worse(std::optional<NextView> a, std::optional<NextView> b) {
  return b && (!a || b->sigma_before_px > a->sigma_before_px) ? std::move(b) : std::move(a);
}

}  // namespace

CalibratedCameras CalibrateByBoards(const Target& target, const CalibrateOptions& options,
                                    std::vector<CameraViews> cameras) {
  CalibratedCameras out{std::move(cameras), {}, {}};
  const std::vector<GuessedCamera> guessed = GuessCameras(options, &out.cameras);
  for (const std::vector<GuessedCamera>& group : GroupsOf(guessed, options.joint)) {
    out.next_view = Worse(std::move(out.next_view), SolveGroup(target, options, group));
  }
  if (options.diagnostics) out.closure = CloseLoops(guessed);
  return out;
}

}  // namespace rgbdt
