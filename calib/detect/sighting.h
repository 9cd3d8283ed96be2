#pragma once

#include "calib/model/cloud.h"
#include "calib/model/image.h"
#include "calib/model/rig.h"
#include "calib/model/view_detection.h"

namespace rgbdt {

/// Whether a camera sees the target, for a person who carries it: fast rather than exact, in the
/// image shrunk to about 1000 px. `text` says why not. Throws InputError where the image is not
/// what the rig says.
Sighting LookForTarget(const Rig& rig, const Image& image);

/// The same for the LIDAR in a whole sweep; `text` says how far away the board is.
Sighting LookForTarget(const Rig& rig, const Cloud& cloud);

}  // namespace rgbdt
