#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calib/model/observation.h"

namespace rgbdt {

struct FirstGuessOptions {
  double rotation_gate_rad = 0.06;    ///< how far the two poses of a board may differ, or 4 sigma
  double distance_gate_m = 0.12;      ///< the same for its centre
  bool range_offset = false;          ///< estimate a constant that the LIDAR's ranges are off by
  double range_offset_sigma_m = 0.1;  ///< its prior, about zero

  /// Throws InputError naming the field and its value.
  void Check() const;
};

/// Which of a view's candidates is the board, if the camera sits where it is said to.
struct CandidateChoice {
  int candidate = -1;      ///< index into Observation::candidates; -1: none fits
  bool half_turn = false;  ///< the candidate's target axes are turned by half a turn
  double rotation_rad =
      0;                  ///< between the board's two poses: the nearest candidate's, if none fits
  double distance_m = 0;  ///< between its two centres
  double cost = 0;        ///< 0: the same pose; from 1 on it does not fit
};

/// A camera's pose from the boards that it and the LIDAR see, from nothing else.
struct FirstGuess {
  std::optional<Rigid3> camera_from_lidar;
  Matrix6d covariance = Matrix6d::Zero();  ///< of delta (rigid3.h), camera axes
  double range_offset_m = 0;               ///< true range minus measured; 0: not estimated
  double range_offset_sigma_m = 0;         ///< 0: not estimated
  int agreeing = 0;                        ///< views that agree on it
  std::string status;                      ///< in words; why there is none
};

/// Closed form: each pair of a camera's board pose and a candidate's in the cloud, turned or not,
/// gives camera_from_lidar; the one that most views agree with is taken and becomes the mean of all
/// that agree, weighed by their covariances. Works for any orientation of the camera, with any
/// number of wrong candidates, and up to half of the views wrong. Says so where views agree on two
/// answers alike (the board always held the same way), and where the images are mirrored.
/// `views` have an image pose and candidates; others are passed over.
FirstGuess GuessFromBoards(const std::vector<const Observation*>& views,
                           const FirstGuessOptions& options = {});

/// The candidate that fits best.
CandidateChoice ChooseCandidate(const Observation& view, const Rigid3& camera_from_lidar,
                                const FirstGuessOptions& options = {});

/// The observation with its `cloud` the candidate that fits; or rejected, with how far off the
/// nearest one lies. Without candidates (the paper's method) it stays as it is.
Observation WithChosenCandidate(Observation view, const Rigid3& camera_from_lidar,
                                const FirstGuessOptions& options = {});

}  // namespace rgbdt
