#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calib/model/beam_priors.h"
#include "calib/model/view_detection.h"
#include "calib/solve/camera_views.h"

namespace rgbdt {

/// How far the camera's and the cloud's pose of one board may differ: 4 sigma, within these limits.
struct PoseGate {
  double least_rad = 0, most_rad = 0;  ///< rotation
  double least_m = 0, most_m = 0;      ///< centre
};

/// A view counts as agreeing with what another view alone says; its board is then paired with the
/// cloud's, and the joint solve says whether it contradicts the others.
inline constexpr PoseGate kVotingGate{0.06, 0.24, 0.12, 0.48};
/// A view is used by methods that do not look for contradictions themselves.
inline constexpr PoseGate kAcceptGate{0.02, 0.075, 0.04, 0.09};
/// A view may judge a calibration that may be wrong itself.
inline constexpr PoseGate kJudgeGate{0.2, 0.4, 0.5, 1.0};

struct FirstGuessOptions {
  /// How well a constant that the LIDAR's ranges may be off by is known, about zero; 0: exactly.
  double range_offset_sigma_m = 0;
  PoseGate accept = kAcceptGate;  ///< how far off the guess a view may lie and still be used

  /// Throws InputError naming the field and its value.
  void Check() const;
};

/// Half a turn about a target's z: how a board's pose may be told otherwise.
inline const Rigid3 kHalfTurn{Eigen::Quaterniond(0, 0, 0, 1), {0, 0, 0}};

/// Of a board without a pattern, whose quarter turns may look alike: a rectangle's never fit.
Rigid3 QuarterTurns(int count);

/// Whether a board's pose, both in one frame, is nearer to `other` once turned by half a turn.
bool HalfTurned(const Rigid3& lidar_from_target, const TargetPose& other);

/// Which of a view's candidates is the board, if the camera sits where it is said to.
struct CandidateChoice {
  int candidate = -1;     ///< index into CameraView::candidates; -1: none fits
  int quarter_turns = 0;  ///< of the candidate's target axes; odd only of a board without a pattern
  double rotation_rad =
      0;                  ///< between the board's two poses: the nearest candidate's, if none fits
  double distance_m = 0;  ///< between its two centres
  double cost = 0;        ///< 0: the same pose; from 1 on it does not fit
};

/// A camera's pose from the boards that it and the LIDAR see, from nothing else.
struct FirstGuess {
  std::optional<Rigid3> camera_from_lidar;
  Matrix6d covariance = Matrix6d::Zero();  ///< of delta (rigid3.h), camera axes
  double range_offset_m = 0;               ///< true range minus measured
  double range_offset_sigma_m = 0;         ///< 0: taken for exact, not estimated
  int agreeing = 0;                        ///< views that agree on it
  bool ambiguous = false;                  ///< there is none because two fit alike
  std::string detail;                      ///< in words; why there is none
};

/// Closed form: each pair of a camera's board pose and a candidate's in the cloud, turned by half a
/// turn or not (without a pattern: by quarters), gives camera_from_lidar; the one that most views
/// agree with is taken and becomes the mean of all that agree, weighed by their covariances. Works
/// for any orientation of the camera, with any number of wrong candidates, and up to half of the
/// views wrong. Says so where views agree on two answers alike (the board always held the same
/// way), and where the images are mirrored. Of `all`, those without an image pose or candidates are
/// passed over.
FirstGuess GuessFromBoards(const std::vector<const CameraView*>& all,
                           const FirstGuessOptions& options = {});

/// The candidate that fits best, the ranges off by so much (true minus measured).
CandidateChoice ChooseCandidate(const CameraView& view, const Rigid3& camera_from_lidar,
                                const PoseGate& gate = kAcceptGate, double range_offset_m = 0);

/// Where one view alone puts the camera: camera_from_lidar = Exp(delta) * guess.
struct BesideGuess {
  Vector6d delta;
  Matrix6d covariance;  ///< of delta, as image and cloud state it
};

/// By the candidate that fits best; nothing where none is near (kJudgeGate).
std::optional<BesideGuess> BesideGuessOf(const CameraView& view, const FirstGuess& guess);

/// The view with its `cloud` the candidate that fits, its image turned by a quarter where that is
/// how the two fit; or rejected, with how far off the nearest one
/// lies. Without poses (the paper's method) it stays as it is.
CameraView WithChosenCandidate(CameraView view, const Rigid3& camera_from_lidar,
                               const PoseGate& gate = kAcceptGate, double range_offset_m = 0);

}  // namespace rgbdt
