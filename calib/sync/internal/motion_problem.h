#pragma once

#include <Eigen/Core>
#include <optional>
#include <utility>
#include <vector>

#include "calib/camera/camera.h"
#include "calib/sync/internal/image_motion.h"
#include "calib/sync/internal/spline.h"
#include "calib/sync/internal/sweep_motion.h"
#include "calib/sync/sync.h"

namespace rgbdt::sync {

/// Of CameraState::changes_s [s]: a place known worse is held by its neighbours only. Not less, as
/// a jump enlarges what is stated.
inline constexpr double kToldChange = 0.025;

/// A camera's unknowns.
struct CameraState {
  Rigid3 camera_from_lidar;
  double offset_s = 0;
  double rolling_s = 0;
  std::vector<double> changes_s;  ///< of the offset, at clock_step_s; straight in between
};

/// All unknowns.
struct MotionState {
  Trajectory way;
  std::vector<CameraState> cameras;
  double range_offset_m = 0;

  /// When an image's middle of the corners was seen, since the way's start [s].
  double SecondsOf(std::size_t camera, const PosedImage& image, double clock_step_s) const;
  /// That without CameraState::changes_s: at this time they are looked up.
  double ByClock(std::size_t camera, const PosedImage& image) const;
};

/// A camera's part of the problem.
struct CameraData {
  Camera camera;
  std::vector<PosedImage> images;
  double sigma_px = 0.1;
  double variance_factor = 1;        ///< of its images
  std::optional<Rigid3> prior_pose;  ///< camera_from_lidar
  Matrix6d prior_covariance = Matrix6d::Zero();
};

struct MotionData {
  Target target;
  std::vector<WavedSweep> sweeps;  ///< what of them lies about the board
  std::vector<CameraData> cameras;
  OnBoard on_board;
  double sweep_variance_factor = 1;
  double range_offset_sigma_m = 0;  ///< 0: it is held
  double clock_step_s = 2;
  double most_gap_s = 0.25;
  bool clocks_change = false;  ///< solve for CameraState::changes_s in place of offset_s
};

/// One sensor's residuals at the end.
struct Misfit {
  double chi2 = 0, freedom = 0;       ///< of poses and motions, over what the unknowns took up
  double point_chi2 = 0, points = 0;  ///< of single corners or points, about these
};

struct MotionCovariance {
  /// Of each camera: offset, rolling, delta of camera_from_lidar (6).
  std::vector<Eigen::Matrix<double, 8, 8>> cameras;
  std::vector<Eigen::MatrixXd> changes;  ///< of CameraState::changes_s, where clocks change
  double range_offset_m2 = 0;
  std::vector<Misfit> camera_misfits;
  Misfit sweep_misfit;
  int sweeps = 0;
  double first_s = 0, last_s = 0;  ///< of the sweeps
};

/// Between which two of a clock's places, `step_s` apart, a time lies, and how far beyond the
/// first.
std::pair<int, double> ClockPlace(double seconds, double step_s, std::size_t places);

/// From where the images have the board: the way of `images`, a camera's, at that offset and pose.
/// `to`: what the knots are to reach, since `start` [s].
Trajectory FirstWay(const std::vector<PosedImage>& images, const CameraState& camera, Utime start,
                    double step_s, double to);

/// Gauss and Newton's steps (by Ceres) until nothing moves, images and sweeps linearised anew in
/// each. False: it did not come to rest.
bool SolveMotion(const MotionData& data, MotionState* state);

/// At the solved state. Nothing: the normal equations are singular.
std::optional<MotionCovariance> CovarianceOf(const MotionData& data, const MotionState& state);

}  // namespace rgbdt::sync
