#include "calib/solve/first_guess.h"

#include <algorithm>
#include <cmath>

#include "calib/model/check.h"
#include "calib/model/linear_algebra.h"

namespace rgbdt {
namespace {

// How well a board's angle [rad] and centre [m] are known.
struct Spread {
  double angle = 0, centre = 0;
};

Spread SpreadOf(const TargetPose& pose) {
  const Eigen::Matrix3d centre =
      PointCovariance(pose.covariance, pose.sensor_from_target.translation);
  return {std::sqrt(std::max(0.0, pose.covariance.topLeftCorner<3, 3>().trace())),
          std::sqrt(std::max(0.0, centre.trace()))};
}

// A board seen by both, and what each makes of it.
struct Pair {
  const TargetPose* in_camera;
  const TargetPose* in_lidar;
  int quarter_turns;

  Rigid3 CameraFromTarget() const {
    return quarter_turns == 0 ? in_camera->sensor_from_target
                              : in_camera->sensor_from_target * QuarterTurns(quarter_turns);
  }
  Rigid3 CameraFromLidar() const {
    return CameraFromTarget() * in_lidar->sensor_from_target.Inverse();
  }
};

// By how much it puts the camera beside a pose.
BesideGuess Beside(const Pair& pair, const Rigid3& camera_from_lidar) {
  const Matrix6d adjoint = Adjoint(camera_from_lidar);
  BesideGuess beside{
      Log(pair.CameraFromLidar() * camera_from_lidar.Inverse()),
      pair.in_camera->covariance + adjoint * pair.in_lidar->covariance * adjoint.transpose()};
  // Nothing is exact: a tenth of a milliradian, a tenth of a millimetre.
  beside.covariance.diagonal().array() += 1e-8;
  return beside;
}

// How it moves the camera's pose that ranges are off by a metre.
Vector6d ByRangeOffset(const Pair& pair, const Rigid3& camera_from_lidar) {
  Vector6d by = Vector6d::Zero();
  by.tail<3>() =
      camera_from_lidar.rotation * pair.in_lidar->sensor_from_target.translation.normalized();
  return by;
}

// In which a view's board may be paired with a candidate. One with a pattern knows its width.
std::vector<int> TurnsOf(const CameraView& view) {
  return view.image->corners.empty() ? std::vector<int>{0, 1, 2, 3} : std::vector<int>{0, 2};
}

// A LIDAR, and how its ranges lie.
struct Mount {
  Rigid3 camera_from_lidar;
  double range_offset_m = 0;
};

CandidateChoice Judge(const Pair& pair, int candidate, const Mount& mount, const PoseGate& gate) {
  const Rigid3 seen = pair.CameraFromTarget();
  Rigid3 board = pair.in_lidar->sensor_from_target;
  board.translation += mount.range_offset_m * board.translation.normalized();
  const Rigid3 meant = mount.camera_from_lidar * board;
  const Spread a = SpreadOf(*pair.in_camera);
  const Spread b = SpreadOf(*pair.in_lidar);
  const double angle = std::clamp(4 * std::hypot(a.angle, b.angle), gate.least_rad, gate.most_rad);
  const double distance = std::clamp(4 * std::hypot(a.centre, b.centre), gate.least_m, gate.most_m);
  CandidateChoice choice{candidate, pair.quarter_turns, RotationDistance(seen, meant),
                         (seen.translation - meant.translation).norm(), 0};
  choice.cost = std::max(choice.rotation_rad / angle, choice.distance_m / distance);
  return choice;
}

// The best pairing of a view, whether it fits or not.
CandidateChoice Nearest(const CameraView& view, const Mount& mount, const PoseGate& gate) {
  CandidateChoice best;
  best.cost = 1e300;
  for (std::size_t k = 0; k < view.candidates.size(); ++k) {
    for (const int quarter_turns : TurnsOf(view)) {
      const Pair pair{&*view.image->pose, &*view.candidates[k]->pose, quarter_turns};
      const CandidateChoice choice = Judge(pair, static_cast<int>(k), mount, gate);
      if (choice.cost < best.cost) best = choice;
    }
  }
  return best;
}

Pair PairOf(const CameraView& view, const CandidateChoice& choice) {
  const CloudEdges& candidate = *view.candidates[static_cast<std::size_t>(choice.candidate)];
  return {&*view.image->pose, &*candidate.pose, choice.quarter_turns};
}

bool HasPoses(const CameraView& view) {
  return view.image && view.image->pose && !view.candidates.empty() &&
         std::all_of(view.candidates.begin(), view.candidates.end(),
                     [](const CloudEdges* c) { return c->pose.has_value(); });
}

using Views = std::vector<const CameraView*>;

// How many views agree with a pose, and how well.
struct Agreement {
  Rigid3 camera_from_lidar;
  int views = 0;
  double cost = 0;  // of those that agree

  bool operator<(const Agreement& other) const {
    return views != other.views ? views < other.views : cost > other.cost;
  }
};

Agreement AgreementOn(const Views& views, const Rigid3& camera_from_lidar) {
  Agreement agreement{camera_from_lidar, 0, 0};
  for (const CameraView* view : views) {
    const double cost = Nearest(*view, {camera_from_lidar}, kVotingGate).cost;
    if (cost >= 1) continue;
    ++agreement.views;
    agreement.cost += cost * cost;
  }
  return agreement;
}

// The pose that one pairing gives and most views agree with; and the best that is a different one.
struct Vote {
  Agreement best, other;
};

// All views vote; of many, some spread evenly propose, or time would grow with their square.
Vote VoteAmong(const Views& views) {
  constexpr std::size_t kProposing = 40;
  std::vector<Agreement> all;
  for (std::size_t v = 0; v < views.size(); v += (views.size() + kProposing - 1) / kProposing) {
    const CameraView* view = views[v];
    for (const CloudEdges* candidate : view->candidates) {
      for (const int quarter_turns : TurnsOf(*view)) {
        const Pair pair{&*view->image->pose, &*candidate->pose, quarter_turns};
        all.push_back(AgreementOn(views, pair.CameraFromLidar()));
      }
    }
  }
  Vote vote;
  for (const Agreement& a : all) vote.best = std::max(vote.best, a);
  for (const Agreement& a : all) {
    if (RotationDistance(a.camera_from_lidar, vote.best.camera_from_lidar) > 0.3 ||
        CentreDistance(a.camera_from_lidar, vote.best.camera_from_lidar) > 0.5) {
      vote.other = std::max(vote.other, a);
    }
  }
  return vote;
}

// The mean of what the agreeing views give, weighed by their covariances; the seventh unknown is
// the range offset. At first any that agreed in the vote; then those near enough to be used.
FirstGuess AverageFrom(const Rigid3& start, const Views& views, const FirstGuessOptions& options) {
  FirstGuess guess;
  guess.camera_from_lidar = start;
  double offset = 0;
  Matrix7d information = Matrix7d::Identity();
  for (int round = 0; round < 12; ++round) {
    Rigid3& pose = *guess.camera_from_lidar;
    information.setZero();
    Vector7d gradient = Vector7d::Zero();
    guess.agreeing = 0;
    for (const CameraView* view : views) {
      const CandidateChoice choice =
          Nearest(*view, {pose, offset}, round < 4 ? kVotingGate : options.accept);
      if (choice.cost >= 1) continue;
      ++guess.agreeing;
      const Pair pair = PairOf(*view, choice);
      const BesideGuess beside = Beside(pair, pose);
      Eigen::Matrix<double, 6, 7> j;
      j.leftCols<6>().setIdentity();
      j.col(6) = ByRangeOffset(pair, pose);
      const Vector6d residual = beside.delta - j.col(6) * offset;
      const Matrix6d weight = InverseOfSymmetric(beside.covariance);
      // Beyond what six Gaussian unknowns do in 3 of 10,000 views, a view counts less.
      const double robust = std::min(1.0, 25 / std::max(1e-12, residual.dot(weight * residual)));
      information += robust * j.transpose() * weight * j;
      gradient += robust * j.transpose() * weight * residual;
    }
    const double prior = std::max(options.range_offset_sigma_m, kNoRangeOffsetSigmaM);
    information(6, 6) += 1 / (prior * prior);
    gradient[6] -= offset / (prior * prior);
    const Vector7d step = SolveSymmetric(information, gradient);
    pose = Exp(step.head<6>()) * pose;
    offset += step[6];
    if (round > 4 && step.norm() < 1e-10) break;
  }
  const Matrix7d covariance = InverseOfSymmetric(information);
  guess.covariance = covariance.topLeftCorner<6, 6>();
  if (options.range_offset_sigma_m > 0) {
    guess.range_offset_m = offset;
    guess.range_offset_sigma_m = std::sqrt(covariance(6, 6));
  }
  return guess;
}

// Left and right of the images swapped back: the board is then mirrored, too.
std::vector<ImageEdges> Unmirrored(const Views& views) {
  std::vector<ImageEdges> out;
  const Eigen::Vector3d mirror(-1, 1, 1);
  for (const CameraView* view : views) {
    out.push_back(*view->image);
    Rigid3& pose = out.back().pose->sensor_from_target;
    const Eigen::Matrix3d r = mirror.asDiagonal() * pose.rotation.toRotationMatrix() *
                              Eigen::Matrix3d(mirror.asDiagonal());
    pose = {Eigen::Quaterniond(r), mirror.asDiagonal() * pose.translation};
  }
  return out;
}

// Views in whose cloud all that looks like the board stands where it does in half of the views or
// more: a thing of the room. (Of a board that was hardly moved the views would agree.)
int OnlyThingsOfTheRoom(const Views& views) {
  constexpr double kSamePlaceM = 0.05;
  constexpr std::size_t kMost = 200;  // of thousands some tell as well
  Views others;
  for (std::size_t v = 0; v < views.size(); v += 1 + views.size() / kMost) {
    others.push_back(views[v]);
  }
  const auto stands = [&](const CloudEdges* edges) {
    const auto is_same = [&](const CloudEdges* other) {
      const Rigid3 &a = edges->pose->sensor_from_target, &b = other->pose->sensor_from_target;
      return (a.translation - b.translation).norm() < kSamePlaceM;
    };
    const auto count = std::count_if(others.begin(), others.end(), [&](const CameraView* view) {
      return std::any_of(view->candidates.begin(), view->candidates.end(), is_same);
    });
    return 2 * count >= static_cast<std::ptrdiff_t>(others.size()) && count > 2;
  };
  return static_cast<int>(std::count_if(views.begin(), views.end(), [&](const CameraView* view) {
    return std::all_of(view->candidates.begin(), view->candidates.end(), stands);
  }));
}

std::string WhyNone(const Views& views, const Vote& vote) {
  const std::string of = std::to_string(views.size()) + " views";
  const std::vector<ImageEdges> images = Unmirrored(views);
  std::vector<CameraView> unmirrored;
  for (std::size_t v = 0; v < views.size(); ++v) {
    unmirrored.push_back(*views[v]);
    unmirrored.back().image = &images[v];
  }
  Views turned;
  for (const CameraView& view : unmirrored) turned.push_back(&view);
  const int mirrored = VoteAmong(turned).best.views;
  if (mirrored > vote.best.views && 2 * mirrored > static_cast<int>(views.size())) {
    return "images or clouds are mirrored: " + std::to_string(mirrored) + " of " + of +
           " agree once left and right are swapped; turn that off in the camera, or, where its "
           "images are as a person sees them, check that the clouds' y points to the left";
  }
  const std::string no_agreement = "the views do not agree where the camera is (at most " +
                                   std::to_string(vote.best.views) + " of " + of + ")";
  const int things = OnlyThingsOfTheRoom(views);
  if (2 * things > static_cast<int>(views.size())) {
    return no_agreement + "; in " + std::to_string(things) +
           " clouds all that looks like the board stands where it does in other views, too, so the "
           "board was not found: is it wholly in the LIDAR's view and nothing touching its sides?";
  }
  return no_agreement +
         "; do images and clouds belong together, and is the whole board, with its border, as "
         "large as the rig file says?";
}

// By a quarter, so that image and cloud differ by half a turn at most. What was the right side is
// the top one then.
void TurnImage(CameraView* view) {
  auto turned = std::make_shared<ImageEdges>(*view->image);
  turned->pose->sensor_from_target = turned->pose->sensor_from_target * QuarterTurns(1);
  std::rotate(turned->sides.begin(), turned->sides.begin() + 1, turned->sides.end());
  std::rotate(turned->outline_corners.begin(), turned->outline_corners.begin() + 1,
              turned->outline_corners.end());
  view->image = turned.get();
  view->turned_image = std::move(turned);
}

}  // namespace

void FirstGuessOptions::Check() const {
  OptionCheck("first guess").NotNegative(range_offset_sigma_m, "range_offset_sigma_m");
}

FirstGuess GuessFromBoards(const std::vector<const CameraView*>& all,
                           const FirstGuessOptions& options) {
  options.Check();
  Views views;
  std::copy_if(all.begin(), all.end(), std::back_inserter(views),
               [](const CameraView* view) { return HasPoses(*view); });
  FirstGuess guess;
  if (views.size() < 2) {
    guess.detail = std::to_string(views.size()) +
                   " views in which both camera and LIDAR see the board; at least 2 are needed";
    return guess;
  }
  const Vote vote = VoteAmong(views);
  guess.agreeing = vote.best.views;
  if (vote.best.views < 2 || 2 * vote.best.views < static_cast<int>(views.size())) {
    guess.detail = WhyNone(views, vote);
    return guess;
  }
  if (vote.other.views >= vote.best.views && vote.other.cost < 4 * vote.best.cost + 0.1) {
    guess.ambiguous = true;
    guess.detail =
        "two poses of the camera fit the views alike; add views with the board elsewhere, tilted "
        "and turned otherwise";
    return guess;
  }
  guess = AverageFrom(vote.best.camera_from_lidar, views, options);
  guess.detail =
      std::to_string(guess.agreeing) + " of " + std::to_string(views.size()) + " views agree";
  return guess;
}

Rigid3 QuarterTurns(int count) {
  Rigid3 turn;
  for (int i = 0; i < count; ++i) turn = turn * Rigid3{{M_SQRT1_2, 0, 0, M_SQRT1_2}, {0, 0, 0}};
  return count == 2 ? kHalfTurn : turn;
}

bool HalfTurned(const Rigid3& lidar_from_target, const TargetPose& other) {
  return RotationDistance(lidar_from_target * kHalfTurn, other.sensor_from_target) <
         RotationDistance(lidar_from_target, other.sensor_from_target);
}

CandidateChoice ChooseCandidate(const CameraView& view, const Rigid3& camera_from_lidar,
                                const PoseGate& gate, double range_offset_m) {
  if (!HasPoses(view)) return {};
  CandidateChoice choice = Nearest(view, {camera_from_lidar, range_offset_m}, gate);
  if (choice.cost >= 1) choice.candidate = -1;
  return choice;
}

std::optional<BesideGuess> BesideGuessOf(const CameraView& view, const FirstGuess& guess) {
  if (!guess.camera_from_lidar) return std::nullopt;
  const Rigid3& pose = *guess.camera_from_lidar;
  const CandidateChoice choice = ChooseCandidate(view, pose, kJudgeGate, guess.range_offset_m);
  if (choice.candidate < 0) return std::nullopt;
  const Pair pair = PairOf(view, choice);
  BesideGuess beside = Beside(pair, pose);
  beside.delta -= ByRangeOffset(pair, pose) * guess.range_offset_m;
  return beside;
}

CameraView WithChosenCandidate(CameraView view, const Rigid3& camera_from_lidar,
                               const PoseGate& gate, double range_offset_m) {
  if (!view.usable() || !HasPoses(view)) return view;
  const CandidateChoice choice = ChooseCandidate(view, camera_from_lidar, gate, range_offset_m);
  if (choice.candidate >= 0) {
    view.cloud = *view.candidates[static_cast<std::size_t>(choice.candidate)];
    if (choice.quarter_turns % 2 == 1) TurnImage(&view);
    return view;
  }
  view.cloud.reset();
  view.Reject("no board in the cloud where the other views put it: the nearest is " +
              std::to_string(std::lround(choice.distance_m * 1000)) + " mm and " +
              std::to_string(std::lround(choice.rotation_rad * 180 / M_PI)) + " deg off");
  return view;
}

}  // namespace rgbdt
