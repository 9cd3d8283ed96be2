#pragma once

#include <functional>
#include <vector>

#include "calib/solve/camera_views.h"
#include "calib/solve/guess_cameras.h"

namespace rgbdt {

/// Between which two views, in the order of their images' times and names, camera and LIDAR are the
/// likeliest to have moved against each other, by what each view alone says of the pose: the mean
/// of those before against that of those after, in terms of how the views scatter on either side.
/// The likeliest first, three at most; none where chance may make as much.
std::vector<MountBreak> LikeliestBreaks(const std::vector<GuessedCamera>& cameras);

/// `calibrated` with a cause in the reports where a mount surely moved at one of its
/// `mount_breaks`: where the views before and after, solved together with a pose each and all else
/// in common, put a camera in two places. `solve` does so with cameras of one name twice. No pose
/// is right for all views then; which one the rig has now, the views after say.
CalibratedCameras WithMovedMountNamed(
    CalibratedCameras calibrated, const std::vector<CameraViews>& cameras,
    const std::function<CalibratedCameras(std::vector<CameraViews>)>& solve);

}  // namespace rgbdt
