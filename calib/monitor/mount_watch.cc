#include "calib/monitor/mount_watch.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "calib/methods/natural/direction_words.h"
#include "calib/model/errors.h"
#include "calib/model/linear_algebra.h"
#include "calib/monitor/mount_odds.h"

namespace rgbdt {
namespace {

constexpr double kDegree = M_PI / 180;
constexpr std::size_t kFewestSweeps = 3;  // of a window that may tell
constexpr double kUntold = 0.5;           // of what a mount may move by: less is not told
constexpr double kDropped = 0.6;          // of the share of edges that images used to show
// A calibration without a covariance; and what none's knows of, e.g. warmth.
constexpr double kUsualRad = 0.1 * kDegree, kUsualM = 0.005;
constexpr double kLeastRad = 0.005 * kDegree, kLeastM = 0.0005;
// How far one looks that is lost, and how much better it must then fit [log-likelihood of an edge].
// It takes a second: less and less often, where it finds nothing.
constexpr std::size_t kMostBetweenSearches = 80;  // sweeps
constexpr double kSearchedRad = 2 * kDegree, kSearchedM = 0.06, kClearly = 0.03;

Vector6d Sigmas(double rotation_rad, double translation_m) {
  Vector6d sigma;
  sigma << Eigen::Vector3d::Constant(rotation_rad), Eigen::Vector3d::Constant(translation_m);
  return sigma;
}

PoseAndLensCovariance PoseAndLensOf(const SceneAlignment& found) {
  PoseAndLensCovariance out;
  out.topLeftCorner<6, 6>() = found.covariance.topLeftCorner<6, 6>();
  out.bottomLeftCorner<kLensNumbers, 6>() = found.covariance.block<kLensNumbers, 6>(kLensAt, 0);
  out.topRightCorner<6, kLensNumbers>() = out.bottomLeftCorner<kLensNumbers, 6>().transpose();
  out.bottomRightCorner<kLensNumbers, kLensNumbers>() =
      found.covariance.bottomRightCorner<kLensNumbers, kLensNumbers>();
  return out;
}

double ShownOf(const SceneAlignment& found) { return found.sums.Depth().Share(); }

void FillWhatIsSeen(const SceneAlignment& found, MountCheck* check) {
  check->edges = found.sums.Depth().edges;
  check->shown = ShownOf(found);
  const double matched = found.sums.All().matched;
  for (std::size_t i = 0; i < check->where.size() && matched > 0; ++i) {
    check->where[i] = found.sums.where[i] / matched;
  }
}

template <typename... Values>
std::string Printed(const char* format, Values... values) {
  char text[200];
  std::snprintf(text, sizeof(text), format, values...);
  return text;
}

// "moved by 0.42 +- 0.05 deg, mostly a turn about the camera's y (yaw), and by 3 +- 4 mm"
std::string MovedWords(const Vector6d& moved, const Matrix6d& covariance) {
  const Eigen::Vector3d turn = moved.head<3>(), way = moved.tail<3>();
  const auto sigma_along = [](const Eigen::Vector3d& by, const Eigen::Matrix3d& own) {
    const Eigen::Vector3d along =
        by.norm() > 0 ? Eigen::Vector3d(by.normalized()) : Eigen::Vector3d::UnitX();
    return std::sqrt(std::max(0.0, along.dot(own * along)));
  };
  return Printed("moved by %.2f +- %.2f deg, mostly ", turn.norm() / kDegree,
                 sigma_along(turn, covariance.topLeftCorner<3, 3>()) / kDegree) +
         DirectionWords([&] {
           Eigen::Index most = 0;
           turn.cwiseAbs().maxCoeff(&most);
           return most;
         }()) +
         Printed(", and by %.0f +- %.0f mm", 1e3 * way.norm(),
                 1e3 * sigma_along(way, covariance.bottomRightCorner<3, 3>()));
}

// "; nothing here tells a turn about the camera's y (yaw): point the camera at vertical edges"
std::string UntoldWords(const MountCheck& check) {
  std::string words;
  for (std::size_t k = 0; k < check.told.size(); ++k) {
    if (check.told[k] > kUntold) continue;
    const auto number = static_cast<Eigen::Index>(k);
    words += "; nothing here tells " + DirectionWords(number) + ": point the camera at " +
             NeededFor(number);
  }
  return words;
}

}  // namespace

void WatchOptions::Check() const {
  if (sweeps < kFewestSweeps) {
    throw InputError("sweeps is " + std::to_string(sweeps) + "; expected " +
                     std::to_string(kFewestSweeps) + " or more");
  }
  if (moved_rad.empty() || moved_rad.size() != moved_m.size()) {
    throw InputError("moved_rad and moved_m have " + std::to_string(moved_rad.size()) + " and " +
                     std::to_string(moved_m.size()) + " sizes; expected as many, one at least");
  }
  if (!(moved_share > 0 && moved_share < 1)) {
    throw InputError("moved_share is " + std::to_string(moved_share) + "; expected 0 to 1");
  }
  if (!(alarm > 0 && alarm < all_clear && all_clear < 1)) {
    throw InputError("alarm is " + std::to_string(alarm) + " and all_clear " +
                     std::to_string(all_clear) + "; expected 0 < alarm < all_clear < 1");
  }
}

MountWatch::MountWatch(const CameraSpec& spec, const WatchOptions& options)
    : rig_spec_(spec), spec_(spec), options_(options) {
  options_.Check();
}

void MountWatch::SetCalibration(const CameraCalibration& calibration, Utime utime) {
  const Rigid3& pose = calibration.camera_from_lidar;
  const bool same = calibration_ && calibration_utime_ == utime &&
                    calibration_->camera_from_lidar.translation == pose.translation &&
                    calibration_->camera_from_lidar.rotation.coeffs() == pose.rotation.coeffs() &&
                    calibration_->timing == calibration.timing;
  if (same) return;
  calibration_ = calibration;
  calibration_utime_ = utime;
  spec_ = calibration.WithSolvedLens(rig_spec_);
  newest_ = pose;
  usual_shown_ = 0;
  moved_ = false;
  since_search_ = search_after_ = options_.sweeps;
}

// What is known of pose and lens where the mount has moved by about so much.
PoseAndLensCovariance MountWatch::Moved(double rotation_rad, double translation_m) const {
  PoseAndLensCovariance known;
  if (calibration_->covariance) {
    known = calibration_->PoseAndLens();
  } else {
    known = WithExactLens(Matrix6d(Sigmas(kUsualRad, kUsualM).cwiseAbs2().asDiagonal()));
    known.bottomRightCorner<kLensNumbers, kLensNumbers>() =
        spec_.LensUncertaintyOrUsual().covariance;
  }
  known.diagonal().head<6>() +=
      Sigmas(std::hypot(kLeastRad, rotation_rad), std::hypot(kLeastM, translation_m)).cwiseAbs2();
  return known;
}

MountWatch::Found MountWatch::Align(const SceneProblem& problem) const {
  NaturalOptions options;
  options.start_covariance = Moved(options_.moved_rad.back(), options_.moved_m.back());
  std::vector<Rigid3> near{calibration_->camera_from_lidar};
  if (moved_) near.push_back(newest_);
  return {AlignNear(problem, calibration_->camera_from_lidar, options, near),
          *options.start_covariance};
}

// Whether the images show far less than they used to.
bool MountWatch::Dropped(const SceneAlignment& found) const {
  return usual_shown_ > 0 && ShownOf(found) < kDropped * usual_shown_;
}

// A large knock: to all sides. Nothing where no other pose fits clearly better.
std::optional<MountWatch::Found> MountWatch::Search(const SceneProblem& problem,
                                                    const SceneAlignment& near) {
  if (since_search_ < search_after_) return std::nullopt;
  since_search_ = 0;
  search_after_ = std::min(2 * search_after_, kMostBetweenSearches);
  NaturalOptions options;
  options.start_covariance = Moved(kSearchedRad, kSearchedM);
  SceneAlignment wide = AlignToScene(problem, calibration_->camera_from_lidar, options);
  if (!wide.fit.converged) return std::nullopt;
  const double better = SceneFitness(problem, wide, wide.fit.camera_from_lidar) -
                        SceneFitness(problem, wide, near.fit.camera_from_lidar);
  if (better < kClearly) return std::nullopt;
  return Found{std::move(wide), *options.start_covariance};
}

// The odds of the two hypotheses, and what follows. `prior`: what the alignment began from.
void MountWatch::Decide(const SceneAlignment& found, const PoseAndLensCovariance& prior,
                        MountCheck* check) {
  const Rigid3& calibrated = calibration_->camera_from_lidar;
  BeforeAndAfter numbers;
  numbers.prior = prior;
  numbers.covariance = PoseAndLensOf(found);
  numbers.mean.resize(kPoseAndLens);
  numbers.mean.head<6>() = Log(found.fit.camera_from_lidar * calibrated.Inverse());
  numbers.mean.tail<kLensNumbers>() = NumbersOf(found.state.lens) - NumbersOf(spec_.lens);
  std::vector<double> moved;
  moved.reserve(options_.moved_rad.size());
  for (std::size_t i = 0; i < options_.moved_rad.size(); ++i) {
    moved.push_back(LogOdds(numbers, Moved(options_.moved_rad[i], options_.moved_m[i])));
  }
  check->holds = HoldsProbability(LogOdds(numbers, Moved(0, 0)), moved, options_.moved_share);
  check->camera_from_lidar = found.fit.camera_from_lidar;
  check->moved = numbers.mean.head<6>();
  check->covariance = numbers.covariance.topLeftCorner<6, 6>();
  for (std::size_t k = 0; k < check->told.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    check->told[k] = std::clamp(1 - numbers.covariance(i, i) / numbers.prior(i, i), 0.0, 1.0);
  }
  if (*check->holds < options_.alarm) moved_ = true;
  if (*check->holds > options_.all_clear) moved_ = false;
  check->state = moved_ ? MountState::kMoved : MountState::kHolds;
  newest_ = check->camera_from_lidar;
}

MountCheck MountWatch::Add(const Shot& shot) {
  shots_.push_back(PrepareShot(spec_, shot, {{}, false, options_.most_edges}, 5));
  if (shots_.size() > options_.sweeps) shots_.pop_front();
  MountCheck check;
  check.camera = rig_spec_.name;
  check.utime = shot.image->utime;
  check.calibration_utime = calibration_utime_;
  check.sweeps = static_cast<int>(shots_.size());
  if (!calibration_) {
    check.text = "no calibration to watch";
    return check;
  }
  check.camera_from_lidar = calibration_->camera_from_lidar;
  if (shots_.size() < kFewestSweeps) {
    check.text = Printed("%zu of %zu sweeps seen", shots_.size(), kFewestSweeps);
    return check;
  }
  ++since_search_;
  const SceneProblem problem(spec_, {shots_.begin(), shots_.end()});
  auto [found, prior] = Align(problem);
  const bool dropped = Dropped(found);
  if (!found.fit.converged || dropped) {
    if (auto wide = Search(problem, found)) {
      found = std::move(wide->alignment);
      prior = wide->prior;
    }
  }
  FillWhatIsSeen(found, &check);
  if (!found.fit.converged) {
    check.state = dropped ? MountState::kLost : MountState::kCannotTell;
    // What follows there is for who refines.
    const std::string why = found.fit.why_not.substr(0, found.fit.why_not.find(": "));
    check.text = dropped
                     ? "does not fit any more, and no pose nearby does (" + why +
                           "): look at the live image with the cloud on it"
                     : "cannot tell (" + why +
                           "): point the camera at things that stand free, "
                           "3 to 10 m away; where this stays so, look at the live image with the "
                           "cloud on it";
    return check;
  }
  search_after_ = options_.sweeps;
  Decide(found, prior, &check);
  if (check.state == MountState::kHolds) {
    usual_shown_ += (check.shown - usual_shown_) / (usual_shown_ > 0 ? 10 : 1);
  }
  check.text = (check.state == MountState::kMoved
                    ? MovedWords(check.moved, check.covariance) +
                          ": fasten the mount, then calibrate again or run `rgbdt refine`"
                    : Printed("holds, as far as %d sweeps tell", check.sweeps)) +
               UntoldWords(check);
  return check;
}

}  // namespace rgbdt
