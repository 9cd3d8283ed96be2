#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "calib/model/rigid3.h"
#include "calib/model/time.h"

namespace rgbdt {

/// Where one camera sits: point_in_camera = camera_from_lidar * point_in_lidar.
struct CameraCalibration {
  std::string camera;
  Rigid3 camera_from_lidar;
  std::optional<Matrix6d> covariance;  ///< of delta (rigid3.h), camera axes; absent: not estimated
  bool converged = false;
  std::string status;  ///< "converged", or why not
};

struct Calibration {
  std::string method;    ///< "paper"
  std::string rig_hash;  ///< the rig it was made with
  Utime utime = 0;       ///< of the newest image used
  std::vector<CameraCalibration> cameras;

  const CameraCalibration* Find(const std::string& camera) const {
    for (const CameraCalibration& c : cameras) {
      if (c.camera == camera) return &c;
    }
    return nullptr;
  }
};

/// A figure over the views used and over the views held out; absent: not to be had.
struct TrainHeldout {
  std::optional<double> train;
  std::optional<double> heldout;
};

/// Difference of two poses of one camera.
struct PoseError {
  double rotation_deg = 0;
  double translation_mm = 0;  ///< between the camera centres, LIDAR frame
};

/// A figure and how sure it is.
struct Estimate {
  double value = 0;
  double sigma = 0;
};

struct RejectedView {
  std::string view;
  std::string why;
};

/// How one view fits.
struct ViewQuality {
  std::string view;
  bool heldout = false;
  double distance_transform_px = 0;
  double edge_rms_px = 0;
};

/// The same solve from another start: how much the start matters.
struct StartResult {
  std::string start;  ///< in words
  CameraCalibration calibration;
  std::optional<double> distance_transform_px;  ///< on the views used
  PoseError from_result;                        ///< against the reported calibration
  std::optional<PoseError> truth_error;
};

struct CameraReport {
  CameraCalibration calibration;
  std::optional<Rigid3> first_guess;  ///< camera_from_lidar that the solve began from
  std::vector<std::string> used, heldout;
  std::vector<RejectedView> rejected;
  TrainHeldout distance_transform_px;  ///< mean distance-transform value (the paper's quality)
  TrainHeldout edge_rms_px;            ///< RMS distance to the fitted outline
  std::vector<ViewQuality> views;
  std::vector<StartResult> other_starts;
  std::optional<Estimate> range_offset;  ///< [m] true range minus measured; absent: not asked for
  std::optional<PoseError> first_guess_error;  ///< against truth, where there is one
  std::optional<PoseError> truth_error;
  double detect_image_s = 0, detect_cloud_s = 0, solve_s = 0;  ///< computing time, all views

  /// Whether the pose is more than the rig's guess: there were views enough to solve it.
  bool solved() const { return distance_transform_px.train.has_value(); }
};

struct Report {
  std::string method;
  std::string rig_hash;
  Utime utime = 0;
  std::vector<CameraReport> cameras;

  /// The cameras that were solved: a guess is no calibration.
  Calibration ToCalibration() const;
};

/// What only a simulator knows. Read by `evaluate --truth` and by tests, never by a node.
struct Truth {
  std::map<std::string, Rigid3> camera_from_lidar;
  std::map<std::string, Rigid3> lidar_from_target;  ///< by view
};

/// Error of `estimate` against `truth`, both camera_from_lidar.
PoseError ErrorOf(const Rigid3& estimate, const Rigid3& truth);

/// Fills in what only truth can tell.
void AddTruth(const Truth& truth, Report* report);

}  // namespace rgbdt
