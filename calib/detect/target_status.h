#pragma once

#include "calib/model/cloud.h"
#include "calib/model/image.h"
#include "calib/model/rig.h"
#include "calib/model/view_detection.h"

namespace rgbdt {

/// Whether a camera sees the target, for a person who carries it: fast rather than exact, in the
/// image shrunk to about 1000 px. `text` gives the reason where it does not. Throws InputError
/// where the image does not match the rig.
TargetStatus LookForTarget(const Rig& rig, const Image& image);

/// The same for the LIDAR in a whole sweep; `text` gives the distance to the board.
TargetStatus LookForTarget(const Rig& rig, const Cloud& cloud);

}  // namespace rgbdt
