#include "calib/solve/by_boards.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "calib/model/stopwatch.h"
#include "calib/solve/by_planes.h"
#include "calib/solve/closure.h"
#include "calib/solve/colouring.h"
#include "calib/solve/cross_check.h"
#include "calib/solve/degenerate.h"
#include "calib/solve/evaluate.h"
#include "calib/solve/joint_solve.h"
#include "calib/solve/next_view.h"

namespace rgbdt {
namespace {

using Views = std::vector<const Observation*>;

// Metres more along each boundary point's beam.
void AddToRanges(double offset_m, CloudEdges* cloud) {
  for (Eigen::Vector3d& p : cloud->boundary) p += offset_m * p.normalized();
}

std::string OneViewStatus(const Views& used) {
  return used.size() == 1 && used[0]->cloud->pose
             ? WhyDegenerate({used[0]->cloud->pose->sensor_from_target})
             : "";
}

bool EnoughViews(const CalibrateOptions& options, CameraViews* camera) {
  const Views used = camera->Used();
  if (static_cast<int>(used.size()) >= options.min_views) return true;
  const std::string degenerate = OneViewStatus(used);
  camera->report.calibration.status =
      degenerate.empty() ? TooFewViews(used.size(), options) : degenerate;
  return false;
}

std::string Place(const Eigen::Vector3d& p) {
  char text[60];
  std::snprintf(text, sizeof text, "x %.1f, y %.1f, z %.1f m", p.x(), p.y(), p.z());
  return text;
}

// Names what else in the clouds looks like the target: a second board, a door, a poster.
void RemarkOthers(CameraViews* camera) {
  int views = 0;
  std::string example;
  for (const Observation* o : camera->Usable()) {
    if (o->candidates.size() < 2) continue;
    ++views;
    const auto other = std::find_if(
        o->candidates.begin(), o->candidates.end(),
        [&](const CloudEdges& c) { return (c.centre - o->cloud->centre).norm() > 0.01; });
    if (!example.empty() || other == o->candidates.end()) continue;
    example = "view " + o->view + ": the target at " + Place(o->cloud->centre) + ", the other at " +
              Place(other->centre) + " (LIDAR frame)";
  }
  if (example.empty()) return;
  camera->report.remarks.push_back(
      "something else of the target's size stands in " + std::to_string(views) + " of " +
      std::to_string(camera->Usable().size()) +
      " clouds, e.g. a second board; the views together chose the target. " + example +
      ". If that is wrong, take the other thing away");
}

// The first guess, from the views used; the views held out have no say, but they choose their board
// by it, too. Without a pose: the status says why.
FirstGuess Guess(const CalibrateOptions& options, CameraViews* camera) {
  FirstGuess guess;
  if (!EnoughViews(options, camera)) return guess;
  guess = GuessFromBoards(camera->Used(), options.first_guess);
  if (!guess.camera_from_lidar) {
    camera->report.calibration.status =
        (guess.ambiguous ? "degenerate: " : "not calibrated: ") + guess.status;
    return guess;
  }
  for (Observation& o : camera->all) {
    o = WithChosenCandidate(std::move(o), *guess.camera_from_lidar);
  }
  if (!EnoughViews(options, camera)) {
    guess.camera_from_lidar.reset();
    return guess;
  }
  camera->report.first_guess = guess.camera_from_lidar;
  RemarkOthers(camera);
  return guess;
}

// Whether every view used says all that a solve needs; observations in old logs do not.
bool CanRefine(const Target& target, const CameraViews& camera) {
  const std::size_t corners = target.InnerCorners().size();
  const Views used = camera.Used();
  return std::all_of(used.begin(), used.end(), [&](const Observation* o) {
    return o->cloud->scatter_sigma_m > 0 && o->image->corners.size() == corners;
  });
}

void TakeGuess(const GuessedCamera& camera, const std::string& status) {
  camera.views->report.calibration = {camera.views->spec->name, *camera.guess.camera_from_lidar,
                                      camera.guess.covariance, true, status};
}

// Places of the boards that a camera was calibrated from.
std::vector<Rigid3> BoardsOf(const CameraViews& camera) {
  std::vector<Rigid3> boards;
  for (const Observation* o : camera.Used()) {
    if (o->cloud->pose) boards.push_back(o->cloud->pose->sensor_from_target);
  }
  return boards;
}

// A pose that the views leave loose is not to be believed, whatever its residuals.
void CheckDegenerate(CameraViews* camera) {
  CameraCalibration& calibration = camera->report.calibration;
  std::string why = WhyDegenerate(BoardsOf(*camera));
  if (why.empty() && calibration.covariance) why = WhyLoose(*calibration.covariance);
  if (why.empty()) return;
  calibration.converged = false;
  calibration.status = why;
  calibration.covariance.reset();
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

// How far the sides differ among each other: what no class explains.
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
    report.calibration = {
        joint.cameras[c].views->spec->name, result.solution.state.camera_from_lidar[c],
        CovarianceOf(result, c), converged,
        converged ? "converged" : "not converged: the joint solve did not settle"};
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

void JudgeAll(const EdgeModel& edges, const std::vector<GuessedCamera>& cameras) {
  for (const GuessedCamera& camera : cameras) {
    JudgeCamera(*camera.views->spec, camera.views->Usable(), &camera.views->report);
    JudgeEdges(edges, camera.views->Usable(), &camera.views->report);
    const CameraCalibration& calibration = camera.views->report.calibration;
    if (!calibration.covariance) continue;
    camera.views->report.sigma =
        SigmaOf(*camera.views->spec, calibration.camera_from_lidar, *calibration.covariance);
  }
}

void ShareTime(double seconds, const std::vector<GuessedCamera>& cameras) {
  for (const GuessedCamera& camera : cameras) {
    camera.views->report.solve_s += seconds / static_cast<double>(cameras.size());
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
  JudgeAll({target, result.solution.state.shared, joint.problem.priors}, cameras);
}

void SolveByPlanes(const Target& target, const std::vector<GuessedCamera>& cameras) {
  for (const GuessedCamera& camera : cameras) {
    const Stopwatch watch;
    CameraReport& report = camera.views->report;
    report.calibration = SolvePlanes(camera.views->Used(), *camera.guess.camera_from_lidar);
    report.calibration.camera = camera.views->spec->name;
    ShareTime(watch.Seconds(), {camera});
    CheckDegenerate(camera.views);
  }
  JudgeAll(EdgeModel{target, BoardPriors().Means(), {}}, cameras);
}

}  // namespace

void CalibrateByBoards(const Target& target, const CalibrateOptions& options,
                       std::vector<CameraViews>* cameras, Report* report) {
  std::vector<GuessedCamera> guessed;
  for (CameraViews& camera : *cameras) {
    const Stopwatch watch;
    const FirstGuess guess = Guess(options, &camera);
    camera.report.solve_s += watch.Seconds();
    if (!guess.camera_from_lidar) continue;
    if (CanRefine(target, camera)) {
      guessed.push_back({&camera, guess});
      continue;
    }
    TakeGuess({&camera, guess},
              "converged; not refined: the observations are of an older rgbdt, without sigmas or "
              "corners");
    CheckDegenerate(&camera);
    JudgeAll(EdgeModel{target, BoardPriors().Means(), {}}, {{&camera, guess}});
  }
  if (options.method == kPlaneMethod) {
    SolveByPlanes(target, guessed);
  } else if (options.joint && !guessed.empty()) {
    SolveGroup(target, options, guessed, report);
  } else {
    for (const GuessedCamera& camera : guessed) SolveGroup(target, options, {camera}, report);
  }
  if (options.diagnostics) report->closure = CloseLoops(guessed);
}

}  // namespace rgbdt
