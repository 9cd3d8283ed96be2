#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calib/model/comparison.h"
#include "calib/solve/camera_views.h"
#include "calib/solve/evaluate.h"
#include "calib/solve/first_guess.h"
#include "calib/solve/lidar_views.h"
#include "calib/solve/options.h"

namespace rgbdt {

/// One camera of the rig in two sessions, solved together with its lens and the LIDAR's errors in
/// common: how far it moved on its mount.
struct MountChange {
  std::size_t from = 0, to = 0;  ///< indices into CalibratedCameras::cameras
  PoseComparison moved;          ///< by the covariance that the two have together
};

/// How late a turned scanner's encoder is stamped, as views have it.
struct EncoderDelay {
  /// Views: one alone may be off for a reason of its own.
  static constexpr std::size_t kLeastEachWay = 2;

  Estimate seconds;                    ///< the variance factor counted in
  double stated_sigma_s = 0;           ///< without it
  double known_sigma_s = 0;            ///< how late an encoder may be where nothing tells
  double turn_rad_s = 0;               ///< how fast the motor turned, mean over the views
  bool all_clouds_tell = true;         ///< which way it turned
  std::size_t views_of_fewer_way = 0;  ///< in which it turned the way that is the rarer
  /// How far all shared unknowns of the solve (SharedPlaces) move by 1 sigma of what is not known
  /// of it after all.
  Eigen::VectorXd unknown_move;

  /// Whether the views can tell it at all.
  bool BothWays() const { return all_clouds_tell && views_of_fewer_way >= kLeastEachWay; }
  /// Whether they tell more of it than is known of any encoder. By what they state, as a delay that
  /// is there makes them scatter.
  bool IsTold() const { return BothWays() && stated_sigma_s < known_sigma_s; }
};

/// Two views, one after the other, between which a mount seems to have moved.
struct MountBreak {
  std::string last_before, first_after;
};

/// What a method makes of the cameras' views: each one's report, and what they say together.
struct CalibratedCameras {
  std::vector<CameraViews> cameras;
  std::vector<LidarReport> lidars{};  ///< beside the reference
  std::vector<MountChange> changes;   ///< of cameras of one name, each against the first of them
  std::vector<Closure> closure;
  std::optional<NextView> next_view;
  /// How late a turned scanner's encoder is stamped; the rough one is by each view alone. Absent:
  /// no motor turned, or not told.
  std::optional<EncoderDelay> encoder_delay{};
  std::optional<Estimate> rough_encoder_delay{};  ///< [s]
  std::vector<MountBreak> mount_breaks{};         ///< by each view alone, the likeliest first
};

/// A camera and where the first guess puts it. With a pose, its usable views know their board;
/// without one, no method can go on, and its report says why.
struct GuessedCamera {
  CameraViews views;
  FirstGuess guess;
};

/// The first guess of each camera, with which a solve begins.
std::vector<GuessedCamera> GuessCameras(const CalibrateOptions& options,
                                        std::vector<CameraViews> cameras);

/// Their views and reports, once no guess is needed any more.
std::vector<CameraViews> WithoutGuesses(std::vector<GuessedCamera> cameras);

/// A camera's calibration with its degeneracy: a pose that the views leave loose is not to be
/// believed, whatever its residuals: its status says so, and its covariance goes.
CameraCalibration WithDegeneracy(const CameraViews& camera);

/// A camera's report with its calibration judged on used and held-out views.
CameraReport JudgeViews(const EdgeModel& edges, const CameraViews& camera);

}  // namespace rgbdt
