#include "calib/solve/internal/mount_moved.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>

#include "calib/model/linear_algebra.h"
#include "calib/model/text.h"
#include "calib/solve/internal/evidence.h"

namespace rgbdt {
namespace {

constexpr std::size_t kLeastEachSide = 2;  // views: one alone may be off for a reason of its own
// Of the change, as unlikely as so many sigmas of one number: it is the largest of those between
// any two views.
constexpr double kSureSigmas = 5;
constexpr std::size_t kMostTried = 3;  // breaks
// By what factor of variance views on one side may scatter beyond what they state.
constexpr double kMostLeft = 2.5;

// What some views say of the pose together, by what each says alone.
struct Together {
  Matrix6d information = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
  double squares = 0;
  std::size_t views = 0;

  void Add(const BesideGuess& view) {
    const Matrix6d weight = InverseOfSymmetric(view.covariance);
    const Vector6d weighted = weight * view.delta;
    information += weight;
    gradient += weighted;
    squares += view.delta.dot(weighted);
    ++views;
  }
  Together Without(const Together& part) const {
    return {information - part.information, gradient - part.gradient, squares - part.squares,
            views - part.views};
  }
  Vector6d Mean() const { return SolveSymmetric(information, gradient); }
  double SquaresAboutMean() const { return std::max(0.0, squares - gradient.dot(Mean())); }
};

// Views are numbered as they were taken, with leading zeros or without.
bool IsBefore(Utime a_utime, const std::string& a, Utime b_utime, const std::string& b) {
  return a_utime != b_utime ? a_utime < b_utime : NaturalLess(a, b);
}

std::vector<const CameraView*> InOrder(const std::vector<CameraView>& all) {
  std::vector<const CameraView*> views(all.size());
  std::transform(all.begin(), all.end(), views.begin(),
                 [](const CameraView& view) { return &view; });
  std::stable_sort(views.begin(), views.end(), [](const CameraView* a, const CameraView* b) {
    return IsBefore(a->image_utime, a->view, b->image_utime, b->view);
  });
  return views;
}

// Cameras take a view's images some milliseconds apart.
bool IsBehind(const CameraView& view, const MountBreak& at) {
  return view.view != at.last_before &&
         IsBefore(at.utime, at.last_before, view.image_utime, view.view);
}

struct Candidate {
  MountBreak at;
  double times = 0;  // of the squares within either side, per degree of freedom
};

std::vector<Candidate> BreaksOf(const GuessedCamera& camera) {
  std::vector<const CameraView*> views;
  std::vector<Together> up_to;  // and with each of them
  Together all;
  for (const CameraView* view : InOrder(camera.views.all)) {
    const auto beside = BesideGuessOf(*view, camera.guess);
    if (!beside) continue;
    all.Add(*beside);
    views.push_back(view);
    up_to.push_back(all);
  }
  std::vector<Candidate> breaks;
  for (std::size_t k = kLeastEachSide; k + kLeastEachSide <= views.size(); ++k) {
    const Together& before = up_to[k - 1];
    const Together behind = all.Without(before);
    const Vector6d apart = behind.Mean() - before.Mean();
    const Matrix6d covariance =
        InverseOfSymmetric(before.information) + InverseOfSymmetric(behind.information);
    const double between = apart.dot(SolveSymmetric(covariance, apart)) / 6;
    const double freedom = 6 * static_cast<double>(views.size() - 2);
    const double within = (before.SquaresAboutMean() + behind.SquaresAboutMean()) / freedom;
    // Views that agree better than they state do not make a difference of theirs larger.
    if (!Exceeds(between, 6, std::max(1.0, within), freedom)) continue;
    breaks.push_back({{views[k - 1]->view, views[k]->view, views[k - 1]->image_utime},
                      between / std::max(1.0, within)});
  }
  return breaks;
}

bool HasOneOfEach(const std::vector<CameraViews>& cameras) {
  std::set<std::string> names;
  return std::all_of(cameras.begin(), cameras.end(), [&](const CameraViews& camera) {
    return names.insert(camera.spec->name).second;
  });
}

// The cameras with the views before, then with those behind; all of them are to be solved by.
std::vector<CameraViews> SplitAt(const MountBreak& at, const std::vector<CameraViews>& cameras) {
  std::vector<CameraViews> split;
  for (const bool behind : {false, true}) {
    for (const CameraViews& camera : cameras) {
      CameraViews part = camera;
      part.all.clear();
      for (CameraView view : camera.all) {
        if (IsBehind(view, at) != behind) continue;
        view.heldout = false;
        part.all.push_back(std::move(view));
      }
      split.push_back(std::move(part));
    }
  }
  return split;
}

std::string WordsOf(const MountBreak& at, const PoseComparison& moved) {
  return Format(
      "%s and the LIDAR moved against each other between views %s and %s, by %.2f deg and %.0f mm: "
      "no pose is right for all views. Leave out those before it (--without), or solve those "
      "before and behind as two sessions (rgbdt calibrate A B --mounts-moved)",
      moved.camera.c_str(), at.last_before.c_str(), at.first_after.c_str(),
      moved.difference.rotation_deg, moved.difference.translation_mm);
}

// How far a camera's result lies beside its pose on one side, in its sigmas.
double SigmasBeside(const CameraReport& result, const CameraReport& on_one_side) {
  const CameraCalibration& all = result.calibration;
  const CameraCalibration& side = on_one_side.calibration;
  if (!all.covariance || !side.solved()) return 0;
  const Vector6d apart = Log(side.camera_from_lidar * all.camera_from_lidar.Inverse());
  return std::sqrt(apart.dot(SolveSymmetric(*all.covariance, apart)));
}

// By camera, where it surely moved. Nothing where the views on either side do not agree among
// themselves: then it is something else that they show.
std::vector<std::optional<Cause>> MovedAt(const MountBreak& at, const CalibratedCameras& apart,
                                          std::size_t cameras) {
  std::vector<std::optional<Cause>> moved(cameras);
  const bool agree = std::all_of(
      apart.cameras.begin(), apart.cameras.end(),
      [](const CameraViews& camera) { return camera.report.variance_factor <= kMostLeft; });
  if (!agree) return moved;
  for (const MountChange& change : apart.changes) {
    if (!change.moved.chi2) continue;
    Cause cause{"mount", WordsOf(at, change.moved), *change.moved.chi2, 6};
    if (cause.Sigmas() >= kSureSigmas) moved[change.from] = std::move(cause);
  }
  return moved;
}

}  // namespace

std::vector<MountBreak> LikeliestBreaks(const std::vector<GuessedCamera>& cameras) {
  std::vector<Candidate> all;
  for (const GuessedCamera& camera : cameras) {
    const std::vector<Candidate> own = BreaksOf(camera);
    all.insert(all.end(), own.begin(), own.end());
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const Candidate& a, const Candidate& b) { return a.times > b.times; });
  std::vector<MountBreak> breaks;
  for (const Candidate& candidate : all) {
    const bool known = std::any_of(breaks.begin(), breaks.end(), [&](const MountBreak& other) {
      return other.last_before == candidate.at.last_before;
    });
    if (!known && breaks.size() < kMostTried) breaks.push_back(candidate.at);
  }
  return breaks;
}

CalibratedCameras WithMovedMountNamed(
    CalibratedCameras calibrated, const std::vector<CameraViews>& cameras,
    const std::function<CalibratedCameras(std::vector<CameraViews>)>& solve) {
  if (!HasOneOfEach(cameras)) return calibrated;
  for (const MountBreak& at : calibrated.mount_breaks) {
    const CalibratedCameras apart = solve(SplitAt(at, cameras));
    const std::vector<std::optional<Cause>> moved = MovedAt(at, apart, cameras.size());
    const auto first = std::find_if(moved.begin(), moved.end(),
                                    [](const auto& cause) { return cause.has_value(); });
    if (first == moved.end()) continue;
    for (std::size_t c = 0; c < cameras.size(); ++c) {
      CameraReport& report = calibrated.cameras[c].report;
      if (!report.calibration.solved()) continue;
      // Cameras that are solved together share boards: one that moved bends the others, too.
      Cause cause = moved[c] ? *moved[c] : **first;
      const double moves = std::max(SigmasBeside(report, apart.cameras[c].report),
                                    SigmasBeside(report, apart.cameras[c + cameras.size()].report));
      if (moves > 1) cause.moves_sigma = moves;
      report.causes.insert(report.causes.begin(), std::move(cause));
    }
    break;
  }
  return calibrated;
}

}  // namespace rgbdt
