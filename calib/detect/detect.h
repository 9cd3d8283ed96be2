#pragma once

#include <vector>

#include "calib/model/observation.h"
#include "calib/model/rig.h"

namespace rgbdt {

/// What one camera and the LIDAR see of the target in one view, by the paper's method; or why it
/// cannot be used. `picks` may be null: the board is then found in the image. Throws InputError
/// for an image that is not the rig's.
Observation DetectOne(const Rig& rig, const View& view, const Image& image,
                      const CornerSelection* picks);

/// One observation for each camera of the rig, in the rig's order; a camera without an image in
/// this view is rejected with that reason.
std::vector<Observation> DetectView(const Rig& rig, const View& view);

}  // namespace rgbdt
