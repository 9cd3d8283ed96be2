#pragma once

#include "calib/model/rig.h"

namespace rgbdt {

/// Whether what the LIDAR's driver reads has an end, after which it is not to be played again.
bool IsRecording(const LidarSpec& lidar);

}  // namespace rgbdt
