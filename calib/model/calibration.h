#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "calib/model/range_errors.h"
#include "calib/model/rig.h"
#include "calib/model/rigid3.h"
#include "calib/model/statistics.h"
#include "calib/model/time.h"
#include "calib/model/verdict.h"

namespace rgbdt {

/// How a camera's solve ended.
enum class SolveStatus {
  kNotSolved = 0,       ///< no pose: too few views, or none that agree
  kUndetermined = 1,    ///< no pose: a single view, or several poses that fit alike
  kNotConverged = 2,    ///< a pose short of the optimum
  kDegenerate = 3,      ///< a pose that the views leave loose in some direction
  kFirstGuessKept = 4,  ///< it fits views left out better than the refined pose
  kConverged = 5,
  kContradicted = 6,  ///< a pose that is not to be used: what was given contradicts the views
};

/// The lens that a camera was solved with, and that belongs to its pose.
struct SolvedLens {
  Lens lens;
  /// Of its numbers (lens.h) with delta (the first six columns) and with each other.
  Eigen::Matrix<double, kLensNumbers, kPoseAndLens> covariance;
};

/// When a camera sees what its images say, against the LIDAR's clock (calib/sync).
struct CameraTiming {
  Estimate time_offset_s;  ///< the LIDAR's time of an image's middle row is its utime + this
  Estimate rolling_s;      ///< as CameraSpec::rolling_s; below 0: the last row comes first

  bool operator==(const CameraTiming& other) const {
    return time_offset_s.value == other.time_offset_s.value &&
           time_offset_s.sigma == other.time_offset_s.sigma &&
           rolling_s.value == other.rolling_s.value && rolling_s.sigma == other.rolling_s.sigma;
  }
  Utime Offset() const { return FromSeconds(time_offset_s.value); }
};

/// Where one camera sits: point_in_camera = camera_from_lidar * point_in_lidar.
struct CameraCalibration {
  std::string camera;
  Rigid3 camera_from_lidar;
  std::optional<Matrix6d> covariance;  ///< of delta (rigid3.h), camera axes; absent: not estimated
  SolveStatus status = SolveStatus::kNotSolved;
  std::string detail;  ///< in words: why, and what to do; empty where there is nothing to say
  /// Absent: the rig file's, which was taken for exact.
  std::optional<SolvedLens> lens{};
  /// What the LIDAR is off by, which belongs to the pose. Absent: ranges were taken as they are.
  std::optional<RangeErrors> range_errors{};
  /// Absent: its clock was not looked at, and images are taken for what their utime says.
  std::optional<CameraTiming> timing{};

  /// Of pose and lens together; needs `covariance`.
  PoseAndLensCovariance PoseAndLens() const;
  /// The camera with the lens that belongs to the pose.
  CameraSpec WithSolvedLens(CameraSpec spec) const;
  /// Whether the pose is more than the rig's guess, be it good or not.
  bool solved() const {
    return status != SolveStatus::kNotSolved && status != SolveStatus::kUndetermined;
  }
  /// Whether the pose is one to use.
  bool converged() const {
    return status == SolveStatus::kConverged || status == SolveStatus::kFirstGuessKept;
  }
  /// Status and detail as a person reads them: "converged", "degenerate: only one view; ...".
  std::string StatusText() const;
};

/// Where a LIDAR beside the reference sits: point_in_reference = reference_from_lidar *
/// point_in_lidar.
struct LidarCalibration {
  std::string lidar;
  Rigid3 reference_from_lidar;
  /// Of delta (rigid3.h), the reference's axes: reference_from_lidar = Exp(delta) * estimate.
  /// Absent: not estimated.
  std::optional<Matrix6d> covariance{};
  SolveStatus status = SolveStatus::kNotSolved;
  std::string detail{};  ///< in words: why, and what to do; empty where there is nothing to say

  bool solved() const {
    return status != SolveStatus::kNotSolved && status != SolveStatus::kUndetermined;
  }
  bool converged() const { return status == SolveStatus::kConverged; }
  /// As CameraCalibration::StatusText.
  std::string StatusText() const;
};

struct Calibration {
  std::string method;    ///< "paper"
  std::string rig_hash;  ///< the rig it was made with
  Utime utime = 0;       ///< of the newest image used
  std::vector<CameraCalibration> cameras;
  /// What it holds for (SensorsOf the rig it was made with); absent: not known.
  std::optional<Rig> sensors{};
  std::vector<LidarCalibration> lidars{};  ///< beside the reference

  const CameraCalibration* Find(const std::string& camera) const {
    for (const CameraCalibration& c : cameras) {
      if (c.camera == camera) return &c;
    }
    return nullptr;
  }
  /// A camera with the lens that belongs to its pose; without a pose as it is.
  CameraSpec WithSolvedLens(const CameraSpec& spec) const {
    const CameraCalibration* found = Find(spec.name);
    return found == nullptr ? spec : found->WithSolvedLens(spec);
  }
};

/// From so many sigmas on, what was given is taken to be wrong: by chance once in 2,000 times, and
/// in one of 130 sessions of two cameras, each of which asks for some eight causes.
inline constexpr double kGivenWrongSigmas = 3.5;

/// Something that was given, which these views contradict: a lens's numbers, the board's size.
struct Cause {
  std::string name;   ///< e.g. "focal length"
  std::string words;  ///< by how much it is off, and what to do about it
  double chi2 = 0;    ///< of what was given against the views
  int freedom = 1;    ///< of chi2
  /// How far the pose moves where it is put right, in its own sigmas. Absent: not known.
  std::optional<double> moves_sigma{};

  /// As unlikely as so many sigmas of one number.
  double Sigmas() const;
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

struct RejectedView {
  std::string view;
  std::string why;
  bool copy = false;  ///< of another view, which counts: nothing speaks against it
};

/// An unknown of the solve besides the poses.
struct Nuisance {
  std::string name;  ///< e.g. "beam edge, no return"
  std::string unit;  ///< "mrad", "mm", "px" or "ms"
  Estimate estimate;
};

/// How one view fits.
struct ViewQuality {
  std::string view;
  bool heldout = false;
  double distance_transform_px = 0;
  double edge_rms_px = 0;
  std::optional<double> edge_rms_whitened;  ///< in sigmas; absent: the method has no crossings
  std::optional<double> edge_rms_mm{};      ///< the same on the board; absent likewise
  /// Of the board's points from the plane where image and calibration put it, what the LIDAR's
  /// ranges were found to be off by taken off; absent likewise.
  std::optional<double> plane_rms_mm{};
};

/// 1 sigma of where a point's colour is taken from.
struct ColouringSigma {
  double distance_m = 0;  ///< of the point from the camera
  double centre_px = 0;   ///< in the image's middle
  double worst_px = 0;    ///< anywhere in the image
};

/// 1 sigma of a camera's pose, from its covariance.
struct PoseSigma {
  std::array<double, 3> rotation_deg{};  ///< about the camera's x, y, z
  std::array<double, 3> centre_mm{};     ///< of the camera's centre, along the LIDAR's x, y, z
  std::vector<ColouringSigma> colouring;
};

/// One part of the views left out, solved from the others and judged on it.
struct Fold {
  std::vector<std::string> heldout;
  double edge_rms_whitened = 0;   ///< of the views left out
  double misfit = 0;              ///< of the views left out: chi-square for each
  double first_guess_misfit = 0;  ///< the same for the first guess from the same views
  PoseError from_result;          ///< against the reported calibration
  double expected_misfit = 6;     ///< of `misfit`, by the noise of views and of the fold's pose
};

/// Two parts of the data, each solved apart: halves of the views, or edges and planes.
struct Halves {
  PoseError difference;
  double chi2 = 0;  ///< by what each part states, six degrees of freedom
  /// By so much the result's sigma was enlarged, so that it allows the difference. Absent: it is as
  /// the parts state it.
  std::optional<double> sigma_enlarged{};
};

/// How far results move as views are left out, over what the views' own sigmas say.
struct ViewScatter {
  double factor = 1;   ///< of variance
  double freedom = 0;  ///< degrees of freedom that tell it

  /// Of chance making it as large, were the views as stated.
  double Chance() const;
};

/// The same solve from another start: how much the start matters.
struct StartResult {
  std::string start;  ///< in words
  CameraCalibration calibration;
  std::optional<double> distance_transform_px;  ///< on the views used
  PoseError from_result;                        ///< against the reported calibration
  std::optional<PoseError> truth_error;
};

/// What a scene without a target says of a pose.
struct SceneCheck {
  double edges = 0;  ///< depth edges of the clouds that lie in the images
  double shown = 0;  ///< of these, the share that the images show, in expectation
  /// On sweeps that the solver never saw: mean log-likelihood of a depth edge, over that of one the
  /// image shows nothing of; absent: none were left out.
  std::optional<double> heldout_start{}, heldout_result{};
  bool joined = false;  ///< with what the start knew of itself by other data
};

struct CameraReport {
  CameraCalibration calibration;
  std::optional<Rigid3> first_guess;  ///< camera_from_lidar that the solve began from
  std::vector<std::string> used, heldout;
  std::vector<RejectedView> rejected;
  /// Why the views cannot all be of one pose, in words; empty: they can, as far as is known.
  std::string contradiction;
  /// What would bend the result and these views cannot tell, in words; empty: nothing known.
  std::string cannot_tell;
  /// What may have been given wrong, the likeliest first: from kGivenWrongSigmas on it is taken to
  /// be, below that it is named where something else says that all is not well.
  std::vector<Cause> causes;
  std::vector<std::string> warnings;   ///< what a person should know of the views, in words
  TrainHeldout distance_transform_px;  ///< mean distance-transform value (the paper's quality)
  TrainHeldout edge_rms_px;            ///< RMS distance to the fitted outline
  TrainHeldout edge_rms_whitened;      ///< RMS of the crossings' distances, each in its sigmas
  TrainHeldout edge_rms_mm;            ///< the same on the board
  TrainHeldout plane_rms_mm;           ///< RMS distance of the board's points from its plane
  std::vector<ViewQuality> views;
  std::vector<StartResult> other_starts;
  std::optional<PoseSigma> sigma;  ///< absent: the method has no covariance
  std::vector<Nuisance> nuisance;
  std::vector<Fold> folds;
  std::optional<Halves> halves;
  /// By the boards' edges alone against by their planes alone. Both have the images' corners, and
  /// the lens, which counts twice in chi2: a large one is sure.
  std::optional<Halves> edges_planes;
  std::optional<SceneCheck> scene;          ///< absent: it was made with a target
  std::optional<ViewScatter> view_scatter;  ///< absent: too few views, or no covariance
  /// By which the covariance was enlarged, as views may scatter more than stated (`view_scatter`).
  double variance_factor = 1;
  std::optional<Verdict> verdict;              ///< absent: not judged (calib/present/report)
  std::optional<PoseError> first_guess_error;  ///< against truth, where there is one
  std::optional<PoseError> truth_error;
  double detect_image_s = 0, detect_cloud_s = 0, solve_s = 0;  ///< computing time, all views
};

/// 1 sigma of a further LIDAR's pose, from its covariance.
struct LidarSigma {
  std::array<double, 3> rotation_deg{};    ///< about the reference's x, y, z
  std::array<double, 3> translation_mm{};  ///< of the LIDAR's origin, along the reference's x, y, z
};

struct LidarReport {
  LidarCalibration calibration;
  std::optional<Rigid3> first_guess;  ///< reference_from_lidar that the solve began from
  std::vector<std::string> used;      ///< views whose cloud of this LIDAR had a say
  std::vector<RejectedView> rejected;
  std::vector<std::string> warnings;
  std::optional<LidarSigma> sigma;  ///< absent: no covariance
  std::vector<Nuisance> nuisance;   ///< its own; the board's stand with the cameras
  std::optional<PoseError> truth_error;
};

/// Two cameras' pose relative to each other, by way of the LIDAR against by their images alone.
struct Closure {
  std::string from, to;         ///< cameras; the pose is to_from_from
  Rigid3 by_lidar;              ///< each camera solved by itself, the two put together
  Rigid3 by_images;             ///< from the views that both see (stereo calibration)
  PoseError difference, sigma;  ///< between the two, and what is to be expected of it (1 sigma)
  double chi2 = 0;              ///< of the difference, six degrees of freedom
};

/// Where to hold the board next, to learn most.
struct NextView {
  std::string words;
  Rigid3 lidar_from_target;
  std::string camera;                              ///< whose sigma is the worst
  double sigma_before_px = 0, sigma_after_px = 0;  ///< worst colouring sigma, before and after it
};

/// What detection found of the target in one view: each image and the cloud apart.
struct DetectedView {
  struct InImage {
    std::string camera;
    std::string why_not;  ///< empty: found
  };
  std::string view;
  bool heldout = false;
  std::vector<InImage> images;
  int cloud_candidates = 0;   ///< all that looks like the target in the cloud
  std::string cloud_why_not;  ///< empty: found
};

struct Report {
  std::string method;
  std::string rig_hash;
  Utime utime = 0;
  std::vector<DetectedView> detections;
  std::vector<CameraReport> cameras;
  std::vector<Closure> closure;
  std::optional<NextView> next_view;
  std::vector<LidarReport> lidars{};  ///< beside the reference, in the rig's order

  /// The cameras and LIDARs that were solved: a guess is no calibration.
  Calibration ToCalibration() const;
};

/// What only a simulator knows. Read by `evaluate --truth` and by tests, never by a node.
struct Truth {
  std::map<std::string, Rigid3> camera_from_lidar;
  std::map<std::string, Rigid3> lidar_from_target;  ///< by view
  /// By view, of a rig that drives; not in files.
  std::map<std::string, Rigid3> world_from_lidar{};
  std::map<std::string, Rigid3> reference_from_lidar{};  ///< by further LIDAR
};

/// Error of `estimate` against `truth`, both camera_from_lidar.
PoseError ErrorOf(const Rigid3& estimate, const Rigid3& truth);

/// Likewise, both reference_from_lidar; the distance is that between the LIDAR's two origins.
PoseError ErrorOfLidar(const Rigid3& estimate, const Rigid3& truth);

/// A report with what only truth can tell.
[[nodiscard]] Report WithTruth(Report report, const Truth& truth);

}  // namespace rgbdt
