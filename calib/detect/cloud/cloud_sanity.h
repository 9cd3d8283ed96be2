#pragma once

#include <string>

#include "calib/model/cloud.h"

namespace rgbdt {

/// What speaks against a cloud as a whole: that its unit is not the metre, or that its axes are not
/// x forward, y left, z up. The axes are told by rings, whose beams make one angle with the axis
/// about which they turn. In words, with what to do; empty: nothing does.
std::string WhyCloudIsOff(const Cloud& cloud);

}  // namespace rgbdt
