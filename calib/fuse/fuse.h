#pragma once

#include <vector>

#include "calib/fuse/fusion_camera.h"
#include "calib/model/cloud.h"
#include "calib/model/rgbdt_cloud.h"

namespace rgbdt {

/// Colours a whole cloud of a rig that stands (see SweepFuser). `range_sigma_m`: noise of its
/// ranges. `seq` and `sweep_end` are left to the caller.
RgbdtCloud Fuse(const Cloud& cloud, const std::vector<FusionCamera>& cameras, double range_sigma_m);

}  // namespace rgbdt
