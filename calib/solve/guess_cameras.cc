#include "calib/solve/guess_cameras.h"

#include <algorithm>
#include <string>
#include <utility>

#include "calib/model/statistics.h"
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
    const std::size_t heldout = camera.Usable().size() - used.size();
    if (used.size() + heldout >= static_cast<std::size_t>(options.min_views)) {
      calibration.detail += "; " + std::to_string(heldout) +
                            " more held out to check the result: take more views, or write "
                            "`heldout: false` into their view.textproto";
    }
  }
  return calibration;
}

std::string Place(const Eigen::Vector3d& p) {
  return Format("x %.1f, y %.1f, z %.1f m", p.x(), p.y(), p.z());
}

// Whether both lie in one plane, and their centres nearer to each other than to their rims.
bool Overlap(const CloudEdges& a, const CloudEdges& b) {
  constexpr double kOnePlaneM = 0.05;  // boards' thickness, and ranges' noise
  const Eigen::Vector3d apart = a.centre - b.centre;
  std::vector<double> to_rim;
  for (const Eigen::Vector3d& point : b.boundary) to_rim.push_back((point - b.centre).norm());
  return !to_rim.empty() && std::abs(apart.dot(b.normal)) < kOnePlaneM &&
         apart.norm() < Median(std::move(to_rim));
}

// Of candidates that the guess takes for the target, besides the one taken: how often they are, and
// the first of them, in words.
struct Rivals {
  int views = 0;
  std::string example;

  void Add(const CameraView& view, const CloudEdges& other) {
    if (views++ > 0) return;
    example = "view " + view.view + ": the target at " + Place(view.cloud->centre) +
              ", the other at " + Place(other.centre) + " (LIDAR frame)";
  }
};

// Two boards of a cloud lie where the guess puts one: only the one taken has a say, and it may be
// the wrong one. What lies elsewhere does no harm. Two in one plane that overlap are one surface,
// larger than the board.
std::vector<std::string> RivalsIn(const CameraViews& camera, const FirstGuess& guess,
                                  const PoseGate& gate) {
  Rivals boards, places;
  for (const CameraView* o : camera.Usable()) {
    const CloudEdges* other_board = nullptr;
    const CloudEdges* other_place = nullptr;
    for (const CloudEdges* candidate : o->candidates) {
      if ((candidate->centre - o->cloud->centre).norm() < 0.01) continue;
      CameraView alone = *o;
      alone.candidates = {candidate};
      const CandidateChoice choice =
          ChooseCandidate(alone, *guess.camera_from_lidar, gate, guess.range_offset_m);
      if (choice.candidate < 0) continue;
      (Overlap(*candidate, *o->cloud) ? other_place : other_board) = candidate;
    }
    if (other_board != nullptr) boards.Add(*o, *other_board);
    if (other_place != nullptr) places.Add(*o, *other_place);
  }
  std::vector<std::string> warnings;
  if (boards.views > 0) {
    warnings.push_back(
        Format("two boards of the target's size stand close together in %d of %zu clouds. %s. "
               "Remove one of them",
               boards.views, camera.Usable().size(), boards.example.c_str()));
  }
  if (places.views > 0) {
    warnings.push_back(
        Format("the board fits in two places of one surface in %d of %zu clouds. %s. Is it larger "
               "than given? Measure its width and height",
               places.views, camera.Usable().size(), places.example.c_str()));
  }
  return warnings;
}

// A camera looks along its own z, a LIDAR's z is up: boards stand beside it. Empty: they do.
std::string AxesAreACameras(const CameraViews& camera) {
  constexpr double kMostUp = 0.8;
  std::vector<double> up;
  for (const CameraView* o : camera.Used()) {
    up.push_back(o->cloud->centre.z() / o->cloud->centre.norm());
  }
  if (!(Median(std::move(up)) > kMostUp)) return "";
  return "the boards lie along the cloud's z axis: its axes seem to be a camera's (x right, y "
         "down, "
         "z forward), and the LIDAR frame is x forward, y left, z up. The result holds for the "
         "clouds as they are";
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
  for (std::string& warning : RivalsIn(views, guess, options.first_guess.accept)) {
    report.warnings.push_back(std::move(warning));
  }
  std::string axes = AxesAreACameras(views);
  if (!axes.empty()) report.warnings.push_back(std::move(axes));
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
