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

bool EnoughViews(const CalibrateOptions& options, CameraViews* camera) {
  const Views used = camera->Used();
  if (static_cast<int>(used.size()) >= options.min_views) return true;
  CameraCalibration& calibration = camera->report.calibration;
  if (used.size() == 1 && used[0]->cloud->pose) {
    calibration.status = SolveStatus::kUndetermined;
    calibration.detail = WhyDegenerate({used[0]->cloud->pose->sensor_from_target});
  } else {
    calibration.detail = TooFewViews(used.size(), options);
  }
  return false;
}

std::string Place(const Eigen::Vector3d& p) {
  return Format("x %.1f, y %.1f, z %.1f m", p.x(), p.y(), p.z());
}

// Names what else in the clouds looks like the target: a second board, a door, a poster.
void WarnOfOthers(CameraViews* camera) {
  int views = 0;
  std::string example;
  for (const CameraView* o : camera->Usable()) {
    if (o->candidates.size() < 2) continue;
    ++views;
    const auto other = std::find_if(
        o->candidates.begin(), o->candidates.end(),
        [&](const CloudEdges* c) { return (c->centre - o->cloud->centre).norm() > 0.01; });
    if (!example.empty() || other == o->candidates.end()) continue;
    example = "view " + o->view + ": the target at " + Place(o->cloud->centre) + ", the other at " +
              Place((*other)->centre) + " (LIDAR frame)";
  }
  if (example.empty()) return;
  camera->report.warnings.push_back(
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
        guess.ambiguous ? SolveStatus::kUndetermined : SolveStatus::kNotSolved;
    camera->report.calibration.detail = guess.detail;
    return guess;
  }
  for (CameraView& o : camera->all) {
    o = WithChosenCandidate(std::move(o), *guess.camera_from_lidar);
  }
  if (!EnoughViews(options, camera)) {
    guess.camera_from_lidar.reset();
    return guess;
  }
  camera->report.first_guess = guess.camera_from_lidar;
  WarnOfOthers(camera);
  return guess;
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

void JudgeCameras(const EdgeModel& edges, const std::vector<GuessedCamera>& cameras) {
  for (const GuessedCamera& camera : cameras) {
    const CameraSpec& spec = *camera.views->spec;
    const Views usable = camera.views->Usable();
    CameraReport& report = camera.views->report;
    report = JudgeEdges(edges, usable, JudgeCamera(spec, usable, std::move(report)));
    const CameraCalibration& calibration = report.calibration;
    if (!calibration.covariance) continue;
    report.sigma = SigmaOf(spec, calibration.camera_from_lidar, *calibration.covariance);
  }
}

void ShareTime(double seconds, const std::vector<GuessedCamera>& cameras) {
  for (const GuessedCamera& camera : cameras) {
    camera.views->report.solve_s += seconds / static_cast<double>(cameras.size());
  }
}

std::vector<GuessedCamera> GuessCameras(const CalibrateOptions& options,
                                        std::vector<CameraViews>* cameras) {
  std::vector<GuessedCamera> guessed;
  for (CameraViews& camera : *cameras) {
    const Stopwatch watch;
    const FirstGuess guess = Guess(options, &camera);
    camera.report.solve_s += watch.Seconds();
    if (guess.camera_from_lidar) guessed.push_back({&camera, guess});
  }
  return guessed;
}

}  // namespace rgbdt
