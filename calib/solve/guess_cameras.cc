#include "calib/solve/guess_cameras.h"

#include <algorithm>
#include <string>
#include <utility>

#include "calib/model/stopwatch.h"
#include "calib/model/text.h"
#include "calib/solve/colouring.h"
#include "calib/solve/internal/degenerate.h"

namespace rgbdt {
namespace {

using Views = std::vector<const CameraView*>;

bool EnoughViews(const CalibrateOptions& options, const CameraViews& camera) {
  return static_cast<int>(camera.Used().size()) >= options.min_views;
}

// Of so few views.
CameraCalibration NotSolved(const CalibrateOptions& options, const CameraViews& camera) {
  CameraCalibration calibration = camera.report.calibration;
  const Views used = camera.Used();
  if (used.size() == 1 && used[0]->cloud->pose) {
    calibration.status = SolveStatus::kUndetermined;
    calibration.detail = WhyDegenerate({used[0]->cloud->pose->sensor_from_target});
  } else {
    calibration.detail = TooFewViews(used.size(), options);
  }
  return calibration;
}

std::string Place(const Eigen::Vector3d& p) {
  return Format("x %.1f, y %.1f, z %.1f m", p.x(), p.y(), p.z());
}

// Names what else in the clouds looks like the target: a second board, a door, a poster. Empty:
// nothing does.
std::string OthersIn(const CameraViews& camera) {
  int views = 0;
  std::string example;
  for (const CameraView* o : camera.Usable()) {
    if (o->candidates.size() < 2) continue;
    ++views;
    const auto other = std::find_if(
        o->candidates.begin(), o->candidates.end(),
        [&](const CloudEdges* c) { return (c->centre - o->cloud->centre).norm() > 0.01; });
    if (!example.empty() || other == o->candidates.end()) continue;
    example = "view " + o->view + ": the target at " + Place(o->cloud->centre) + ", the other at " +
              Place((*other)->centre) + " (LIDAR frame)";
  }
  if (example.empty()) return "";
  return "something else of the target's size stands in " + std::to_string(views) + " of " +
         std::to_string(camera.Usable().size()) +
         " clouds, e.g. a second board; the views together chose the target. " + example +
         ". If that is wrong, take the other thing away";
}

// The first guess, from the views used; the views held out have no say, but they choose their board
// by it, too.
GuessedCamera Guess(const CalibrateOptions& options, CameraViews views) {
  CameraReport& report = views.report;
  if (!EnoughViews(options, views)) {
    report.calibration = NotSolved(options, views);
    return {std::move(views), {}};
  }
  FirstGuess guess = GuessFromBoards(views.Used(), options.first_guess);
  if (!guess.camera_from_lidar) {
    report.calibration.status =
        guess.ambiguous ? SolveStatus::kUndetermined : SolveStatus::kNotSolved;
    report.calibration.detail = guess.detail;
    return {std::move(views), std::move(guess)};
  }
  for (CameraView& o : views.all) {
    o = WithChosenCandidate(std::move(o), *guess.camera_from_lidar, options.first_guess.accept,
                            guess.range_offset_m);
  }
  if (!EnoughViews(options, views)) {
    report.calibration = NotSolved(options, views);
    return {std::move(views), {}};
  }
  report.first_guess = guess.camera_from_lidar;
  const std::string others = OthersIn(views);
  if (!others.empty()) report.warnings.push_back(others);
  return {std::move(views), std::move(guess)};
}

// Places of the boards that a camera was calibrated from.
std::vector<Rigid3> BoardsOf(const CameraViews& camera) {
  std::vector<Rigid3> boards;
  for (const CameraView* o : camera.Used()) {
    if (o->cloud->pose) boards.push_back(o->cloud->pose->sensor_from_target);
  }
  return boards;
}

}  // namespace

CameraCalibration WithDegeneracy(const CameraViews& camera) {
  CameraCalibration calibration = camera.report.calibration;
  std::string why = WhyDegenerate(BoardsOf(camera));
  if (why.empty() && calibration.covariance) why = WhyLoose(*calibration.covariance);
  if (why.empty()) return calibration;
  calibration.status = SolveStatus::kDegenerate;
  calibration.detail = why;
  calibration.covariance.reset();
  return calibration;
}

CameraReport JudgeViews(const EdgeModel& edges, const CameraViews& camera) {
  const Views usable = camera.Usable();
  CameraReport report = JudgeEdges(edges, usable, JudgeCamera(*camera.spec, usable, camera.report));
  const CameraCalibration& calibration = report.calibration;
  if (calibration.covariance) report.sigma = SigmaOf(*camera.spec, calibration);
  return report;
}

std::vector<GuessedCamera> GuessCameras(const CalibrateOptions& options,
                                        std::vector<CameraViews> cameras) {
  std::vector<GuessedCamera> guessed;
  for (CameraViews& camera : cameras) {
    const Stopwatch watch;
    guessed.push_back(Guess(options, std::move(camera)));
    guessed.back().views.report.solve_s += watch.Seconds();
  }
  return guessed;
}

std::vector<CameraViews> WithoutGuesses(std::vector<GuessedCamera> cameras) {
  std::vector<CameraViews> views;
  views.reserve(cameras.size());
  for (GuessedCamera& camera : cameras) views.push_back(std::move(camera.views));
  return views;
}

}  // namespace rgbdt
