#pragma once

#include <string>

#include "calib/detect/cloud/range_grid.h"
#include "calib/model/cloud.h"
#include "calib/model/rig.h"

namespace rgbdt {

/// What speaks against a cloud as a whole: that its unit is not the metre, that its coordinates are
/// rounded to 5 mm or more, that its axes are not x forward, y left, z up, or that it is in another
/// frame than the LIDAR's own. Axes and frame are told by rings, whose beams make one angle with
/// the axis about which they turn, and meet in a point. In words, with what to do; empty: nothing
/// does.
std::string WhyCloudIsOff(const Cloud& cloud);

/// Of a cloud in which no board was found: that hardly anything but a board is there. Where the
/// board ends, so does the cloud, and nothing says that its beams passed the board. In words, with
/// what to do; empty: there is more.
std::string WhyCutOut(const Cloud& cloud, const Target& target);

/// Of a spinning LIDAR's cloud in which no board was found: that its rings cannot be told, as its
/// beams do not meet in a point and nothing numbers them. Likewise.
std::string WhyNoRings(const RangeGrid& grid);

}  // namespace rgbdt
