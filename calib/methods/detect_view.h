#pragma once

#include <string>
#include <vector>

#include "calib/model/method.h"
#include "calib/model/observation.h"
#include "calib/model/rig.h"

namespace rgbdt {

/// What each camera and the LIDAR see of the target in one view, or why it cannot be used: one
/// observation for each camera of the rig, in the rig's order. The first image of a camera is
/// looked at; where there are more, taken during the sweep, the board must not have moved.
/// "auto" finds the board in image and cloud by itself; in an image where it does not, a person's
/// picks, if there are any, say where to measure it. "paper" takes picks, where there are any, for
/// the outline, and needs the rig's hand-measured guess. Throws InputError for an image that is not
/// the rig's and for an unknown method.
std::vector<Observation> DetectView(const Rig& rig, const View& view,
                                    const std::string& method = kAutoMethod);

}  // namespace rgbdt
