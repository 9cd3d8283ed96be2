#include "calib/solve/internal/cross_check.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calib/model/text.h"
#include "calib/solve/evaluate.h"

namespace rgbdt {
namespace {

constexpr double kMostMisfit = 50;

// Views of the joint problem, every `parts`-th from `part` on left out or, inverted, taken.
std::vector<std::size_t> Others(std::size_t views, std::size_t part, std::size_t parts,
                                bool taken) {
  std::vector<std::size_t> out;
  for (std::size_t v = 0; v < views; ++v) {
    if ((v % parts == part) == taken) out.push_back(v);
  }
  return out;
}

std::vector<const CameraView*> ViewsOf(const JointProblem& joint, std::size_t camera,
                                       const std::vector<std::size_t>& views) {
  std::vector<const CameraView*> out;
  for (const std::size_t v : views) {
    const CameraView* o = joint.cameras[camera].views.Find(joint.problem.views[v].name);
    if (o != nullptr) out.push_back(o);
  }
  return out;
}

// A camera's part in one fold.
struct Judged {
  Fold fold;
  std::vector<double> worse;  // by view left out: the refined misfit minus the guess's
};

// A view left out against a camera's pose, by that camera's image and the reference's cloud alone;
// bounded, so that one wrong view does not decide.
Misfit MisfitOf(const JointProblem& joint, const BoardSolution& fold, std::size_t view,
                std::size_t camera, const Rigid3& camera_from_lidar, const Lens& lens) {
  auto [alone, state] = Part(joint.problem, {view}, joint.start);
  alone.lidars.clear();
  state.lidars.clear();
  std::vector<BoardImage>& images = alone.views[0].images;
  images.erase(
      std::remove_if(images.begin(), images.end(),
                     [&](const BoardImage& s) { return s.camera != static_cast<int>(camera); }),
      images.end());
  state.camera_from_lidar = fold.state.camera_from_lidar;
  state.camera_from_lidar[camera] = camera_from_lidar;
  state.lenses[camera] = lens;
  state.shared = fold.state.shared;
  state.range_terms = fold.state.range_terms;
  state.lidar_from_target[0] = alone.views[0].cloud.pose->sensor_from_target;
  state.side_shift[0] = {};
  Misfit misfit = MisfitOf(alone, state, 0, static_cast<int>(camera));
  misfit.chi2 = std::min(kMostMisfit, misfit.chi2);
  return misfit;
}

Judged JudgeFold(const JointProblem& joint, const BoardSolution& solution, std::size_t camera,
                 const std::vector<std::size_t>& left_out, const FirstGuess& guess) {
  const CameraReport& report = joint.cameras[camera].views.report;
  const PoseAndLensCovariance covariance =
      solution.PoseAndLens(SharedPlaces(joint.problem), camera);
  const CameraCalibration fold_calibration{
      report.calibration.camera, solution.state.camera_from_lidar[camera],
      Matrix6d(covariance.topLeftCorner<6, 6>()), SolveStatus::kConverged, ""};
  const EdgeModel edges{joint.problem.target, solution.state.shared, joint.problem.priors};
  Judged judged;
  judged.fold.expected_misfit = 0;
  judged.fold.from_result =
      ErrorOf(fold_calibration.camera_from_lidar, report.calibration.camera_from_lidar);
  EdgeMisfit sum;
  for (const std::size_t view : left_out) {
    const CameraView* o = joint.cameras[camera].views.Find(joint.problem.views[view].name);
    if (o == nullptr) continue;
    judged.fold.heldout.push_back(o->view);
    const EdgeMisfit edge = MisfitOfEdges(edges, *o, fold_calibration);
    sum.squared += edge.squared;
    sum.count += edge.count;
    const Misfit refined =
        MisfitOf(joint, solution, view, camera, fold_calibration.camera_from_lidar,
                 solution.state.lenses[camera]);
    const double guessed = MisfitOf(joint, solution, view, camera, *guess.camera_from_lidar,
                                    joint.problem.cameras[camera].lens())
                               .chi2;
    judged.fold.misfit += refined.chi2;
    judged.fold.expected_misfit += refined.Expected(covariance);
    judged.fold.first_guess_misfit += guessed;
    judged.worse.push_back(refined.chi2 - guessed);
  }
  const auto judges = static_cast<double>(std::max<std::size_t>(1, judged.fold.heldout.size()));
  judged.fold.misfit /= judges;
  judged.fold.expected_misfit /= judges;
  judged.fold.first_guess_misfit /= judges;
  judged.fold.edge_rms_whitened = sum.count > 0 ? std::sqrt(sum.squared / sum.count) : 0;
  return judged;
}

// Whether the guess fits better by more than chance: the sum against twice its own scatter. What a
// view says by itself is far coarser than these two poses differ.
bool GuessIsBetter(const std::vector<double>& worse) {
  double sum = 0;
  double squares = 0;
  for (const double w : worse) {
    sum += w;
    squares += w * w;
  }
  return sum > 2 * std::sqrt(squares);
}

CameraCalibration KeptGuess(const GuessedCamera& camera) {
  const CameraReport& report = camera.views.report;
  double refined = 0;
  double guessed = 0;
  for (const Fold& fold : report.folds) {
    refined += fold.misfit / static_cast<double>(report.folds.size());
    guessed += fold.first_guess_misfit / static_cast<double>(report.folds.size());
  }
  return {report.calibration.camera, *camera.guess.camera_from_lidar, camera.guess.covariance,
          SolveStatus::kFirstGuessKept,
          Format("on views left out it fits better than the refined pose (chi-square %.1f against "
                 "%.1f a view)",
                 guessed, refined)};
}

JointResult LeaveOutParts(JointResult result, std::size_t parts) {
  JointProblem& joint = result.joint;
  std::vector<std::vector<double>> worse(joint.cameras.size());
  for (std::size_t part = 0; part < parts; ++part) {
    const std::size_t count = joint.problem.views.size();
    const auto kept = Others(count, part, parts, false);
    const BoardSolution solution = SolveSome(joint.problem, result.solution, kept);
    for (std::size_t c = 0; c < joint.cameras.size(); ++c) {
      const auto left_out = Others(count, part, parts, true);
      const FirstGuess guess = GuessFromBoards(ViewsOf(joint, c, kept));
      if (!guess.camera_from_lidar || !solution.converged) continue;
      Judged judged = JudgeFold(joint, solution, c, left_out, guess);
      if (judged.worse.empty()) continue;
      worse[c].insert(worse[c].end(), judged.worse.begin(), judged.worse.end());
      joint.cameras[c].views.report.folds.push_back(std::move(judged.fold));
    }
  }
  for (std::size_t c = 0; c < joint.cameras.size(); ++c) {
    joint.cameras[c].views.report.calibration = TheBetter(joint.cameras[c], worse[c]);
  }
  return result;
}

JointResult Halve(JointResult result) {
  JointProblem& joint = result.joint;
  const std::size_t count = joint.problem.views.size();
  const BoardSolution a = SolveSome(joint.problem, result.solution, Others(count, 0, 2, true));
  const BoardSolution b = SolveSome(joint.problem, result.solution, Others(count, 1, 2, true));
  for (std::size_t c = 0; c < joint.cameras.size(); ++c) {
    joint.cameras[c].views.report.halves = Apart(a, b, result.variance_factor, c);
  }
  return result;
}

}  // namespace

CameraCalibration TheBetter(const GuessedCamera& camera, const std::vector<double>& worse) {
  return GuessIsBetter(worse) ? KeptGuess(camera) : camera.views.report.calibration;
}

JointResult CrossValidate(JointResult result, int folds) {
  const std::size_t views = result.joint.problem.views.size();
  if (views < 4) return result;
  result = LeaveOutParts(std::move(result), std::min(views, static_cast<std::size_t>(folds)));
  if (views >= 6) result = Halve(std::move(result));
  return result;
}

}  // namespace rgbdt
