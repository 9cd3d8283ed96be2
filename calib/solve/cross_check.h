#pragma once

#include <vector>

#include "calib/model/calibration.h"
#include "calib/solve/joint_solve.h"

namespace rgbdt {

/// How well a pose fits a view that had no say in it: chi-square of the difference between the pose
/// that the view gives by itself and this one, by the view's own covariance; bounded, so that one
/// wrong view does not decide. `view` is usable, with the poses of its board.
double MisfitOf(const Observation& view, const Rigid3& camera_from_lidar);

/// Fills in `folds` and `halves` of the cameras' reports: each part of the views left out once,
/// solved from the others and judged on it, beside the first guess from the same others; and two
/// halves of the views solved apart. Where the first guess fits what was left out better, the
/// guess is kept: it becomes the report's calibration, and the status says so. Nothing
/// with fewer than 4 views.
void CrossValidate(const JointProblem& joint, const JointResult& result, int folds);

/// Each pair of cameras: their relative pose by way of the LIDAR, each camera by itself, against
/// stereo calibration from the views that both see. Both from the boards' poses, weighed by their
/// covariances, so that the difference's own covariance can be told: the clouds' errors are common
/// to both cameras and mostly cancel.
std::vector<Closure> CloseLoops(const std::vector<GuessedCamera>& cameras);

}  // namespace rgbdt
