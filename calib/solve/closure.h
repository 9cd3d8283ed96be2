#pragma once

#include <vector>

#include "calib/model/calibration.h"
#include "calib/solve/guess_cameras.h"

namespace rgbdt {

/// Each pair of cameras that have a guess: their relative pose by way of the LIDAR, each camera by
/// itself, against stereo calibration from the views that both see. Both from the boards' poses,
/// weighed by their covariances, so that the difference's own covariance can be told: the clouds'
/// errors are common to both cameras and mostly cancel.
std::vector<Closure> CloseLoops(const std::vector<GuessedCamera>& cameras);

}  // namespace rgbdt
