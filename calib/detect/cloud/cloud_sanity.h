#pragma once

#include <string>

#include "calib/model/cloud.h"

namespace rgbdt {

/// What speaks against a cloud as a whole: that its unit is not the metre, that its coordinates are
/// rounded to 5 mm or more, that its axes are not x forward, y left, z up, or that it is in another
/// frame than the LIDAR's own. Axes and frame are told by rings, whose beams make one angle with
/// the axis about which they turn, and meet in a point. In words, with what to do; empty: nothing
/// does.
std::string WhyCloudIsOff(const Cloud& cloud);

}  // namespace rgbdt
