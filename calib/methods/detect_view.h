#pragma once

#include <string>

#include "calib/model/method.h"
#include "calib/model/rig.h"
#include "calib/model/view_detection.h"

namespace rgbdt {

/// What each camera of the rig and the LIDAR see of the target in one view, or why it cannot be
/// used. The first image of a camera is looked at; where there are more, taken during the sweep,
/// the board must not have moved. "auto" finds the board in images and cloud, each by itself; in an
/// image where it does not, a person's picks, if there are any, say where to measure it. "paper"
/// takes picks, where there are any, for the outline, and finds the board in the cloud once a
/// camera, by the rig's hand-measured guess. Throws InputError for an image that is not the rig's
/// and for an unknown method.
ViewDetection DetectView(const Rig& rig, const View& view, const std::string& method = kAutoMethod);

}  // namespace rgbdt
