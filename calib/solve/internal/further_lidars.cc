#include "calib/solve/internal/further_lidars.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>
#include <string>
#include <utility>

#include "calib/model/text.h"
#include "calib/solve/first_guess.h"

namespace rgbdt {
namespace {

// The boards of all views as a camera would have them whose frame is the reference's, beside a
// further LIDAR's candidates: reference_from_lidar is then what GuessFromBoards calls
// camera_from_lidar.
class BoardPairs {
 public:
  BoardPairs(const BoardProblem& problem, const LidarViews& lidar) {
    for (const BoardView& board : problem.views) {
      CameraView& pair = pairs_.emplace_back();
      pair.view = board.name;
      const auto found = lidar.candidates.find(board.name);
      if (found == lidar.candidates.end()) continue;
      ImageEdges& seen = boards_.emplace_back();
      seen.pose = board.cloud.pose;
      pair.image = &seen;
      for (const CloudEdges& candidate : found->second) pair.candidates.push_back(&candidate);
    }
  }
  BoardPairs(const BoardPairs&) = delete;
  BoardPairs& operator=(const BoardPairs&) = delete;

  FirstGuess Guess() const {
    std::vector<const CameraView*> views;
    for (const CameraView& pair : pairs_) {
      if (pair.image != nullptr) views.push_back(&pair);
    }
    FirstGuessOptions options;
    options.accept = kVotingGate;  // what contradicts the rest is found by the solve
    return GuessFromBoards(views, options);
  }

  // By view of the problem; without a candidate to take no pose is known (CandidateChoice).
  const std::vector<CameraView>& all() const { return pairs_; }

 private:
  std::vector<CameraView> pairs_;
  std::deque<ImageEdges> boards_;  // whose addresses stay
};

// A cloud whose target's axes are turned by quarters, so that they are the reference's: with p its
// pose and the reference's turned by `quarter_turns` against it.
CloudEdges Turned(CloudEdges cloud, int quarter_turns) {
  cloud.pose->sensor_from_target =
      cloud.pose->sensor_from_target * QuarterTurns((4 - quarter_turns) % 4);
  for (Crossing& crossing : cloud.crossings) crossing.side = (crossing.side + quarter_turns) % 4;
  return cloud;
}

// A LIDAR's part of each view; without a board where it has none that fits.
std::vector<BoardView> CloudsBy(const BoardPairs& pairs, const Rigid3& reference_from_lidar,
                                LidarReport* report) {
  std::vector<BoardView> clouds;
  for (const CameraView& pair : pairs.all()) {
    BoardView& view = clouds.emplace_back();
    view.name = pair.view;
    if (pair.image == nullptr) continue;
    const CandidateChoice choice = ChooseCandidate(pair, reference_from_lidar, kVotingGate);
    if (choice.candidate < 0) {
      report->rejected.push_back(
          {pair.view,
           Format("no board in this LIDAR's cloud where the other views put it: the nearest is "
                  "%.0f mm and %.0f deg off",
                  1000 * choice.distance_m, choice.rotation_rad * 180 / M_PI)});
      continue;
    }
    view.cloud =
        Turned(*pair.candidates[static_cast<std::size_t>(choice.candidate)], choice.quarter_turns);
  }
  return clouds;
}

std::string WhyNoGuess(const FirstGuess& guess) {
  if (guess.ambiguous) {
    return "two poses of this LIDAR fit the views alike; add views with the board elsewhere, "
           "tilted and turned otherwise";
  }
  return "the views do not agree where this LIDAR is (at most " + std::to_string(guess.agreeing) +
         " of them); do its clouds belong to these views, and did the board stand still?";
}

// Views whose boards are seen by this LIDAR, and by nobody else: said, as nobody would know why.
void RejectUnused(const BoardProblem& reference, LidarViews* lidar) {
  for (const auto& [name, candidates] : lidar->candidates) {
    const auto used = std::find_if(reference.views.begin(), reference.views.end(),
                                   [&view = name](const BoardView& b) { return b.name == view; });
    if (used == reference.views.end()) {
      lidar->report.rejected.push_back(
          {name, "neither a camera's image nor the reference's cloud of this view was used"});
    }
  }
}

// Nothing, and the report says why, where there is no first guess.
std::optional<BoardProblem> ProblemOf(const BoardProblem& reference, int min_views,
                                      double reference_offset_sigma_m, LidarViews* lidar) {
  const BoardPairs pairs(reference, *lidar);
  const auto seen = std::count_if(pairs.all().begin(), pairs.all().end(),
                                  [](const CameraView& pair) { return pair.image != nullptr; });
  LidarReport& report = lidar->report;
  if (seen < min_views) {
    report.calibration.detail = TooFewClouds(static_cast<int>(seen), min_views);
    return std::nullopt;
  }
  const FirstGuess guess = pairs.Guess();
  if (!guess.camera_from_lidar) {
    report.calibration.status =
        guess.ambiguous ? SolveStatus::kUndetermined : SolveStatus::kNotSolved;
    report.calibration.detail = WhyNoGuess(guess);
    return std::nullopt;
  }
  report.first_guess = guess.camera_from_lidar;
  BoardProblem problem;
  problem.target = reference.target;
  problem.priors = PriorsOf(reference.target);
  problem.views = CloudsBy(pairs, *guess.camera_from_lidar, &report);
  const auto clouds =
      std::count_if(problem.views.begin(), problem.views.end(),
                    [](const BoardView& view) { return view.cloud.pose.has_value(); });
  if (clouds < min_views) {
    report.calibration.detail = TooFewClouds(static_cast<int>(clouds), min_views);
    return std::nullopt;
  }
  OpenRanges(lidar->range_offset_sigma_m, &problem);
  // What hides an offset by a plain board is its rim in images, of which two clouds know nothing.
  if (lidar->range_offset_sigma_m > 0 && !reference.PatternIsSeen()) {
    const bool held = reference.priors.range_offset_sigma_m < reference_offset_sigma_m;
    problem.priors.range_offset_sigma_m =
        std::hypot(lidar->range_offset_sigma_m, held ? reference_offset_sigma_m : 0);
  }
  return problem;
}

}  // namespace

std::string TooFewClouds(int views, int needed) {
  return Format(
      "%d views in which this LIDAR, the reference and a camera see the board alike; at least %d "
      "are needed",
      views, needed);
}

void AddLidars(std::vector<LidarViews> lidars, int min_views, double reference_offset_sigma_m,
               JointProblem* joint) {
  std::vector<Rigid3> guesses;
  for (LidarViews& lidar : lidars) {
    RejectUnused(joint->problem, &lidar);
    auto problem = ProblemOf(joint->problem, min_views, reference_offset_sigma_m, &lidar);
    if (!problem) {
      joint->lidars_left.push_back(std::move(lidar));
      continue;
    }
    joint->problem.lidars.push_back(std::move(*problem));
    guesses.push_back(*lidar.report.first_guess);
    joint->lidars.push_back(std::move(lidar));
  }
  joint->start.lidars = StartOf(joint->problem, joint->start.camera_from_lidar, guesses).lidars;
}

int CloudsOf(const BoardProblem& problem, std::size_t lidar) {
  int count = 0;
  for (std::size_t v = 0; v < problem.views.size(); ++v) {
    count += HasCloud(problem, lidar, v) ? 1 : 0;
  }
  return count;
}

void RejectCloud(const Contradiction& worst, JointProblem* joint) {
  const std::size_t lidar = *worst.lidar;
  BoardView& view = joint->problem.lidars[lidar].views[worst.view];
  ++joint->lidars[lidar].contradicting;
  joint->lidars[lidar].report.rejected.push_back(
      {view.name,
       Format("contradicts the other %d views: by itself it would put this LIDAR %.2f deg and %.0f "
              "mm elsewhere; did board or rig move, or does something stand against the board?",
              CloudsOf(joint->problem, lidar) - 1, worst.rotation_deg, worst.centre_mm)});
  view.cloud = {};
}

}  // namespace rgbdt
