#include "calib/solve/cross_check.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "calib/solve/evaluate.h"

namespace rgbdt {
namespace {

constexpr double kMostMisfit = 50;
using Index = Eigen::Index;

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
Matrix6d ByImage(const Observation& view) {
  return kCornersAlike * kCornersAlike * view.image->pose->covariance;
}

Alone FromOneView(const Observation& view, const Rigid3& near) {
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

const Observation* FindView(const GuessedCamera& camera, const std::string& view) {
  for (const Observation* o : camera.views->Used()) {
    if (o->view == view) return o;
  }
  return nullptr;
}

// Views of the joint problem, every `parts`-th from `part` on left out or, inverted, taken.
std::vector<std::size_t> Others(std::size_t views, std::size_t part, std::size_t parts,
                                bool taken) {
  std::vector<std::size_t> out;
  for (std::size_t v = 0; v < views; ++v) {
    if ((v % parts == part) == taken) out.push_back(v);
  }
  return out;
}

BoardSolution SolvePart(const JointProblem& joint, const BoardState& near,
                        const std::vector<std::size_t>& views) {
  BoardState start;
  const BoardProblem part = Part(joint.problem, views, near, &start);
  return SolveBoards(part, start);
}

std::vector<const Observation*> ViewsOf(const JointProblem& joint, std::size_t camera,
                                        const std::vector<std::size_t>& views) {
  std::vector<const Observation*> out;
  for (const std::size_t v : views) {
    const Observation* o = FindView(joint.cameras[camera], joint.problem.views[v].name);
    if (o != nullptr) out.push_back(o);
  }
  return out;
}

// A camera's part in one fold.
struct Judged {
  Fold fold;
  std::vector<double> worse;  // by view left out: the refined misfit minus the guess's
};

// A view left out against a camera's pose, by that camera's image alone; bounded, so that one wrong
// view does not decide.
double MisfitOf(const JointProblem& joint, const BoardSolution& fold, std::size_t view,
                std::size_t camera, const Rigid3& camera_from_lidar) {
  BoardState state;
  BoardProblem alone = Part(joint.problem, {view}, joint.start, &state);
  std::vector<BoardSight>& sights = alone.views[0].sights;
  sights.erase(
      std::remove_if(sights.begin(), sights.end(),
                     [&](const BoardSight& s) { return s.camera != static_cast<int>(camera); }),
      sights.end());
  state.camera_from_lidar = fold.state.camera_from_lidar;
  state.camera_from_lidar[camera] = camera_from_lidar;
  state.shared = fold.state.shared;
  state.lidar_from_target[0] = alone.views[0].cloud.pose->sensor_from_target;
  state.side_shift[0] = {};
  return std::min(kMostMisfit, MisfitOf(alone, state, 0, static_cast<int>(camera)));
}

Judged JudgeFold(const JointProblem& joint, const BoardSolution& solution, std::size_t camera,
                 const std::vector<std::size_t>& left_out, const FirstGuess& guess) {
  const CameraReport& report = joint.cameras[camera].views->report;
  const auto at = static_cast<Index>(6 * camera);
  const CameraCalibration fold_calibration{
      report.calibration.camera, solution.state.camera_from_lidar[camera],
      Matrix6d(solution.covariance.block<6, 6>(at, at)), true, ""};
  const EdgeModel edges{joint.problem.target, solution.state.shared, joint.problem.priors};
  Judged judged;
  judged.fold.from_result =
      ErrorOf(fold_calibration.camera_from_lidar, report.calibration.camera_from_lidar);
  EdgeMisfit sum;
  std::size_t judges = 0;
  for (const std::size_t view : left_out) {
    const Observation* o = FindView(joint.cameras[camera], joint.problem.views[view].name);
    if (o == nullptr) continue;
    ++judges;
    judged.fold.heldout.push_back(o->view);
    const EdgeMisfit edge = MisfitOfEdges(edges, *o, fold_calibration);
    sum.squared += edge.squared;
    sum.count += edge.count;
    const double refined =
        MisfitOf(joint, solution, view, camera, fold_calibration.camera_from_lidar);
    const double guessed = MisfitOf(joint, solution, view, camera, *guess.camera_from_lidar);
    judged.fold.misfit += refined;
    judged.fold.first_guess_misfit += guessed;
    judged.worse.push_back(refined - guessed);
  }
  judged.fold.misfit /= static_cast<double>(std::max<std::size_t>(1, judges));
  judged.fold.first_guess_misfit /= static_cast<double>(std::max<std::size_t>(1, judges));
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

void KeepGuess(const GuessedCamera& camera) {
  CameraReport& report = camera.views->report;
  double refined = 0;
  double guessed = 0;
  for (const Fold& fold : report.folds) {
    refined += fold.misfit / static_cast<double>(report.folds.size());
    guessed += fold.first_guess_misfit / static_cast<double>(report.folds.size());
  }
  char text[200];
  std::snprintf(text, sizeof text,
                "converged; the first guess was kept: on views left out it fits better than the "
                "refined pose (chi-square %.1f against %.1f a view)",
                guessed, refined);
  report.calibration.camera_from_lidar = *camera.guess.camera_from_lidar;
  report.calibration.covariance = camera.guess.covariance;
  report.calibration.status = text;
}

void LeaveOutParts(const JointProblem& joint, const JointResult& result, std::size_t parts) {
  std::vector<std::vector<double>> worse(joint.cameras.size());
  for (std::size_t part = 0; part < parts; ++part) {
    const std::size_t count = joint.problem.views.size();
    const auto kept = Others(count, part, parts, false);
    const BoardSolution solution = SolvePart(joint, result.solution.state, kept);
    for (std::size_t c = 0; c < joint.cameras.size(); ++c) {
      const auto left_out = Others(count, part, parts, true);
      const FirstGuess guess = GuessFromBoards(ViewsOf(joint, c, kept));
      if (!guess.camera_from_lidar || !solution.converged) continue;
      Judged judged = JudgeFold(joint, solution, c, left_out, guess);
      if (judged.worse.empty()) continue;
      worse[c].insert(worse[c].end(), judged.worse.begin(), judged.worse.end());
      joint.cameras[c].views->report.folds.push_back(std::move(judged.fold));
    }
  }
  for (std::size_t c = 0; c < joint.cameras.size(); ++c) {
    KeepTheBetter(joint.cameras[c], worse[c]);
  }
}

void Halve(const JointProblem& joint, const JointResult& result) {
  const std::size_t count = joint.problem.views.size();
  const BoardSolution a = SolvePart(joint, result.solution.state, Others(count, 0, 2, true));
  const BoardSolution b = SolvePart(joint, result.solution.state, Others(count, 1, 2, true));
  for (std::size_t c = 0; c < joint.cameras.size(); ++c) {
    const Rigid3& pose_a = a.state.camera_from_lidar[c];
    const Rigid3& pose_b = b.state.camera_from_lidar[c];
    const auto at = static_cast<Index>(6 * c);
    const Matrix6d covariance = result.variance_factor * (a.covariance.block<6, 6>(at, at) +
                                                          b.covariance.block<6, 6>(at, at));
    const Vector6d delta = Log(pose_a * pose_b.Inverse());
    Halves halves{ErrorOf(pose_a, pose_b), delta.dot(covariance.ldlt().solve(delta))};
    joint.cameras[c].views->report.halves = halves;
  }
}

}  // namespace

void KeepTheBetter(const GuessedCamera& camera, const std::vector<double>& worse) {
  if (GuessIsBetter(worse)) KeepGuess(camera);
}

void CrossValidate(const JointProblem& joint, const JointResult& result, int folds) {
  const std::size_t views = joint.problem.views.size();
  if (views < 4) return;
  LeaveOutParts(joint, result, std::min(views, static_cast<std::size_t>(folds)));
  if (views >= 6) Halve(joint, result);
}

namespace {

// Two cameras' relative pose, and what each of their views brings in.
struct Loop {
  const GuessedCamera* a;
  const GuessedCamera* b;
  Rigid3 b_from_a;

  std::vector<std::pair<const Observation*, const Observation*>> Shared() const {
    std::vector<std::pair<const Observation*, const Observation*>> shared;
    for (const Observation* o : a->views->Used()) {
      const Observation* other = FindView(*b, o->view);
      if (other != nullptr) shared.emplace_back(o, other);
    }
    return shared;
  }
};

// The mean of a camera's views, weighed: its pose and each view's weight in it.
struct Mean {
  Rigid3 camera_from_lidar;
  std::map<std::string, Matrix6d> weight;
};

Mean MeanOf(const GuessedCamera& camera) {
  Mean mean{*camera.guess.camera_from_lidar, {}};
  for (int round = 0; round < 3; ++round) {
    Matrix6d information = Matrix6d::Zero();
    Vector6d gradient = Vector6d::Zero();
    mean.weight.clear();
    for (const Observation* o : camera.views->Used()) {
      const Alone alone = FromOneView(*o, mean.camera_from_lidar);
      const Matrix6d weight = alone.Covariance().ldlt().solve(Matrix6d::Identity());
      information += weight;
      gradient += weight * Log(alone.camera_from_lidar * mean.camera_from_lidar.Inverse());
      mean.weight[o->view] = weight;
    }
    const auto solver = information.ldlt();
    for (auto& [view, weight] : mean.weight) weight = Matrix6d(solver.solve(weight));
    mean.camera_from_lidar = Exp(Vector6d(solver.solve(gradient))) * mean.camera_from_lidar;
  }
  return mean;
}

// Relative pose from one view's images; they may be told from opposite ends of the board.
Rigid3 ByImages(const Observation& a, const Observation& b, const Rigid3& near) {
  const Rigid3 straight =
      b.image->pose->sensor_from_target * a.image->pose->sensor_from_target.Inverse();
  const Rigid3 turned =
      b.image->pose->sensor_from_target * kHalfTurn * a.image->pose->sensor_from_target.Inverse();
  return RotationDistance(turned, near) < RotationDistance(straight, near) ? turned : straight;
}

std::optional<Closure> CloseLoop(const GuessedCamera& camera_a, const GuessedCamera& camera_b) {
  const Mean mean_a = MeanOf(camera_a);
  const Mean mean_b = MeanOf(camera_b);
  const Loop loop{&camera_a, &camera_b,
                  mean_b.camera_from_lidar * mean_a.camera_from_lidar.Inverse()};
  const auto shared = loop.Shared();
  if (shared.size() < 3) return std::nullopt;
  const Matrix6d b_by_a = Adjoint(loop.b_from_a);
  Rigid3 stereo = loop.b_from_a;
  std::vector<Matrix6d> weights;
  for (int round = 0; round < 3; ++round) {
    Matrix6d information = Matrix6d::Zero();
    Vector6d gradient = Vector6d::Zero();
    weights.clear();
    for (const auto& [a, b] : shared) {
      const Matrix6d covariance =
          ByImage(*b) + b_by_a * ByImage(*a) * b_by_a.transpose() + 1e-10 * Matrix6d::Identity();
      const Vector6d off = Log(ByImages(*a, *b, stereo) * stereo.Inverse());
      const Matrix6d weight = covariance.ldlt().solve(Matrix6d::Identity());
      const double robust = std::min(1.0, 25 / std::max(1e-12, off.dot(weight * off)));
      information += robust * weight;
      gradient += robust * weight * off;
      weights.push_back(robust * weight);
    }
    for (Matrix6d& weight : weights) weight = Matrix6d(information.ldlt().solve(weight));
    stereo = Exp(Vector6d(information.ldlt().solve(gradient))) * stereo;
  }
  // The difference as a sum over the views' errors: of image a, of image b, of the cloud.
  Matrix6d covariance = Matrix6d::Zero();
  const auto add = [&](const Matrix6d& by, const Matrix6d& of) {
    covariance += by * of * by.transpose();
  };
  const auto weight_of = [](const Mean& mean, const std::string& view) {
    const auto found = mean.weight.find(view);
    return found == mean.weight.end() ? Matrix6d(Matrix6d::Zero()) : found->second;
  };
  std::map<std::string, const Observation*> all;
  for (const Observation* o : camera_a.views->Used()) all[o->view] = o;
  for (const Observation* o : camera_b.views->Used()) all[o->view] = o;
  for (const auto& [view, any] : all) {
    const Observation* a = FindView(camera_a, view);
    const Observation* b = FindView(camera_b, view);
    Matrix6d by_stereo = Matrix6d::Zero();
    for (std::size_t i = 0; i < shared.size(); ++i) {
      if (shared[i].first->view == view) by_stereo = weights[i];
    }
    const Matrix6d weight_a = b_by_a * weight_of(mean_a, view);
    const Matrix6d weight_b = weight_of(mean_b, view);
    if (a != nullptr) {
      add(weight_a - by_stereo * b_by_a, ByImage(*a));
    }
    if (b != nullptr) add(weight_b - by_stereo, ByImage(*b));
    const Matrix6d cloud_a = a == nullptr ? Matrix6d(Matrix6d::Zero())
                                          : Matrix6d(weight_a * Adjoint(mean_a.camera_from_lidar));
    const Matrix6d cloud_b = b == nullptr ? Matrix6d(Matrix6d::Zero())
                                          : Matrix6d(weight_b * Adjoint(mean_b.camera_from_lidar));
    add(cloud_b - cloud_a, any->cloud->pose->covariance);
  }
  const Vector6d delta = Log(stereo * loop.b_from_a.Inverse());
  Closure closure;
  closure.from = camera_a.views->spec->name;
  closure.to = camera_b.views->spec->name;
  closure.by_lidar = loop.b_from_a;
  closure.by_images = stereo;
  closure.difference = ErrorOf(stereo, loop.b_from_a);
  closure.sigma = {std::sqrt(covariance.topLeftCorner<3, 3>().trace()) * 180 / M_PI,
                   std::sqrt(covariance.bottomRightCorner<3, 3>().trace()) * 1000};
  closure.chi2 = delta.dot(covariance.ldlt().solve(delta));
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
