#pragma once

#include <vector>

#include "calib/fuse/fusion_camera.h"
#include "calib/model/calibration.h"
#include "calib/model/cloud.h"
#include "calib/model/rgbdt_cloud.h"
#include "calib/model/view_detection.h"

namespace rgbdt {

/// Colours a whole cloud of a rig that stands (see SweepFuser). `range_sigma_m`: noise of its
/// ranges. `seq` and `sweep_end` are left to the caller.
RgbdtCloud Fuse(const Cloud& cloud, const std::vector<FusionCamera>& cameras, double range_sigma_m);

/// Colours a view's cloud with its images, whatever their times; cameras without a calibration
/// colour nothing. `sweep_end` is set. Throws InputError for an image that is not the rig's.
RgbdtCloud FuseView(const Rig& rig, const Calibration& calibration, const View& view);

}  // namespace rgbdt
