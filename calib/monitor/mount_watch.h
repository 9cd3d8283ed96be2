#pragma once

#include <cstddef>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "calib/methods/natural/by_scene.h"
#include "calib/model/calibration.h"
#include "calib/model/mount_check.h"
#include "calib/model/rig.h"
#include "calib/model/shot.h"

namespace rgbdt {

struct WatchOptions {
  std::size_t sweeps = 5;  ///< the newest so many tell
  /// Of the mounts that are looked at, so many have moved: before anything is seen.
  double moved_share = 0.02;
  /// By what a mount moves: about each of the camera's axes and along each (1 sigma), small,
  /// middling and large knocks alike.
  std::vector<double> moved_rad = {0.002, 0.007, 0.02};
  std::vector<double> moved_m = {0.004, 0.012, 0.03};
  double alarm = 0.02;            ///< called moved from a probability of holding below this
  double all_clear = 0.5;         ///< until it is above this
  std::size_t most_edges = 4000;  ///< of a sweep

  /// Throws InputError naming the field and its value.
  void Check() const;
};

/// Watches one camera's mount, sweep by sweep: whether the calibration still holds, by the depth
/// edges of the newest sweeps on their images (methods/natural). The calibration with its
/// covariance is one hypothesis; the same, moved by what a knock is like, is the other; the
/// window's data are as likely as they are under either (mount_odds.h). Memory is that of a
/// window's edges and image gradients: some 20 MB a sweep of 2.8 megapixels.
class MountWatch {
 public:
  explicit MountWatch(const CameraSpec& spec, const WatchOptions& options = {});

  /// From now on this one is watched; nothing changes where it is the one at hand. Sweeps seen
  /// before stay: they tell of it, too.
  void SetCalibration(const CameraCalibration& calibration, Utime utime);
  bool calibrated() const { return calibration_.has_value(); }
  const std::optional<CameraCalibration>& calibration() const { return calibration_; }
  const CameraSpec& spec() const { return spec_; }

  /// Takes a sweep and this camera's image of the same moment. Throws InputError for an image that
  /// is not this camera's.
  MountCheck Add(const Shot& shot);

 private:
  struct Found {
    SceneAlignment alignment;
    PoseAndLensCovariance prior;  // that it was solved with
  };
  void Decide(const SceneAlignment& found, const PoseAndLensCovariance& prior, MountCheck* check);
  Found Align(const SceneProblem& problem) const;
  std::optional<Found> Search(const SceneProblem& problem, const SceneAlignment& near);
  PoseAndLensCovariance Moved(double rotation_rad, double translation_m) const;
  bool Dropped(const SceneAlignment& found) const;

  CameraSpec rig_spec_, spec_;  // as given; with the calibration's lens
  WatchOptions options_;
  std::optional<CameraCalibration> calibration_;
  Utime calibration_utime_ = 0;
  std::deque<std::shared_ptr<const SceneShot>> shots_;
  Rigid3 newest_;           // where it was found last
  double usual_shown_ = 0;  // share of edges that images showed while it held; 0: not known
  bool moved_ = false;
  std::size_t since_search_ = 0, search_after_ = 0;  // sweeps
};

}  // namespace rgbdt
