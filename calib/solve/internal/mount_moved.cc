#include "calib/solve/internal/mount_moved.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

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
constexpr double kMostScatter = 2.5;

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

// In which order views were taken: by when their images were, where all are known, else by their
// names, numbered with leading zeros or without.
class ViewOrder {
 public:
  void Add(const std::vector<CameraView>& views) {
    for (const CameraView& view : views) {
      Utime& first = taken_[view.view];
      if (first == 0 || (view.image_utime > 0 && view.image_utime < first)) {
        first = view.image_utime;
      }
    }
    timed_ =
        std::all_of(taken_.begin(), taken_.end(), [](const auto& view) { return view.second > 0; });
  }

  bool IsBefore(const std::string& a, const std::string& b) const {
    const Utime at_a = taken_.at(a), at_b = taken_.at(b);
    return timed_ && at_a != at_b ? at_a < at_b : NaturalLess(a, b);
  }

 private:
  std::map<std::string, Utime> taken_;  // a view's first image; 0: not known
  bool timed_ = false;
};

struct Candidate {
  MountBreak at;
  double times = 0;  // of the squares within either side, per degree of freedom
};

std::vector<Candidate> BreaksOf(const GuessedCamera& camera, const ViewOrder& order) {
  std::vector<const CameraView*> in_order(camera.views.all.size());
  std::transform(camera.views.all.begin(), camera.views.all.end(), in_order.begin(),
                 [](const CameraView& view) { return &view; });
  std::stable_sort(in_order.begin(), in_order.end(), [&](const CameraView* a, const CameraView* b) {
    return order.IsBefore(a->view, b->view);
  });
  std::vector<const CameraView*> views;
  std::vector<Together> up_to;  // and with each of them
  Together all;
  for (const CameraView* view : in_order) {
    const auto beside = BesideGuessOf(*view, camera.guess);
    if (!beside) continue;
    all.Add(*beside);
    views.push_back(view);
    up_to.push_back(all);
  }
  std::vector<Candidate> breaks;
  for (std::size_t k = kLeastEachSide; k + kLeastEachSide <= views.size(); ++k) {
    const Together& before = up_to[k - 1];
    const Together after = all.Without(before);
    const Vector6d apart = after.Mean() - before.Mean();
    const Matrix6d covariance =
        InverseOfSymmetric(before.information) + InverseOfSymmetric(after.information);
    const double between = apart.dot(SolveSymmetric(covariance, apart)) / 6;
    const double freedom = 6 * static_cast<double>(views.size() - 2);
    const double within = (before.SquaresAboutMean() + after.SquaresAboutMean()) / freedom;
    // Views that agree better than they state do not make a difference of theirs larger.
    if (!Exceeds(between, 6, std::max(1.0, within), freedom)) continue;
    breaks.push_back({{views[k - 1]->view, views[k]->view}, between / std::max(1.0, within)});
  }
  return breaks;
}

// Of several sessions it is known when one ended and the next began: CalibrateSessions says it.
bool IsOneSession(const std::vector<CameraViews>& cameras) {
  std::set<std::string> names;
  return std::all_of(cameras.begin(), cameras.end(), [&](const CameraViews& camera) {
    const bool of_several = std::any_of(
        camera.all.begin(), camera.all.end(),
        [](const CameraView& view) { return view.view.find('/') != std::string::npos; });
    return !of_several && names.insert(camera.spec->name).second;
  });
}

// The cameras with the views before, then with those after; all of them are to be solved by.
std::vector<CameraViews> SplitAt(const MountBreak& at, const std::vector<CameraViews>& cameras) {
  ViewOrder order;
  for (const CameraViews& camera : cameras) order.Add(camera.all);
  std::vector<CameraViews> split;
  for (const bool after : {false, true}) {
    for (const CameraViews& camera : cameras) {
      CameraViews part = camera;
      part.all.clear();
      for (CameraView view : camera.all) {
        if (order.IsBefore(at.last_before, view.view) != after) continue;
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
      "before and after as two sessions (rgbdt calibrate A B --mounts-moved)",
      moved.camera.c_str(), at.last_before.c_str(), at.first_after.c_str(),
      moved.difference.rotation_deg, moved.difference.translation_mm);
}

// How far a camera's result lies beside its pose on one side, in its sigmas.
double SigmasBeside(const CameraReport& result, const CameraReport& on_one_side) {
  const CameraCalibration& all = result.calibration;
  const CameraCalibration& side = on_one_side.calibration;
  if (!all.covariance || !side.converged()) return 0;
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
      [](const CameraViews& camera) { return camera.report.variance_factor <= kMostScatter; });
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
  ViewOrder order;
  for (const GuessedCamera& camera : cameras) order.Add(camera.views.all);
  std::vector<Candidate> all;
  for (const GuessedCamera& camera : cameras) {
    const std::vector<Candidate> own = BreaksOf(camera, order);
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
  if (!IsOneSession(cameras)) return calibrated;
  for (const MountBreak& at : calibrated.mount_breaks) {
    const CalibratedCameras apart = solve(SplitAt(at, cameras));
    const std::vector<std::optional<Cause>> moved = MovedAt(at, apart, cameras.size());
    bool any = false;
    for (std::size_t c = 0; c < cameras.size(); ++c) {
      CameraReport& report = calibrated.cameras[c].report;
      if (!moved[c] || !report.calibration.solved()) continue;
      any = true;
      Cause cause = *moved[c];
      const double moves = std::max(SigmasBeside(report, apart.cameras[c].report),
                                    SigmasBeside(report, apart.cameras[c + cameras.size()].report));
      if (moves > 1) cause.moves_sigma = moves;
      const auto less_sure =
          std::find_if(report.causes.begin(), report.causes.end(),
                       [&](const Cause& other) { return other.Sigmas() < cause.Sigmas(); });
      report.causes.insert(less_sure, std::move(cause));
    }
    if (any) break;
  }
  return calibrated;
}

}  // namespace rgbdt
