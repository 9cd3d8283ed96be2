#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "calib/solve/camera_views.h"
#include "calib/solve/guess_cameras.h"
#include "calib/solve/internal/joint_solve.h"

namespace rgbdt {

/// How late the encoder is stamped, as the views have it. A cloud that was assembled by an encoder
/// stamped late by d, the motor at rate w, lies turned by -w d about the LIDAR's z. Where all
/// sweeps turn one way, the cameras' poses take that up, unseen; where they turn both ways, it is a
/// score test (given_wrong.h) along a direction of each view's own: W_v = w_v
/// Adjoint(camera_from_lidar) z. Nothing where no motor turned.
std::optional<EncoderDelay> EncoderDelayOf(const JointResult& result);

/// From the boards' poses in each view alone, which stand any delay: the cameras' residual turns
/// about the LIDAR's z, sweeps one way against those the other way. Nothing where fewer than two
/// views turn either way.
std::optional<Estimate> RoughEncoderDelay(const std::vector<GuessedCamera>& cameras);

/// The views with their clouds where they lie once such a delay is taken off [s].
CameraViews WithoutEncoderDelay(CameraViews camera, double delay_s);

/// Calibrates with the delay taken off that the views tell; where they tell none, as they are. What
/// was found stands in each camera's report: as a nuisance, as a cause where it is there beyond
/// doubt, as what cannot be told where all sweeps turn one way. `calibrate` does so with a delay
/// taken off [s].
CalibratedCameras CalibrateWithoutEncoderDelay(
    const std::function<CalibratedCameras(double delay_s)>& calibrate);

}  // namespace rgbdt
