#pragma once

#include <vector>

#include "calib/model/cloud.h"
#include "calib/model/rig.h"
#include "calib/model/view_detection.h"

namespace rgbdt {

/// The points of a cloud on a board that was found there with a pose, told apart by the line of the
/// scanner: one group a line, its rising, with its points where they were measured, about the
/// board's centre (CloudEdges::groups). A line is what one laser of a spinning LIDAR sees, or one
/// beam of a turned scanner: Cloud::ring; where the cloud does not tell, its line. The board's rim
/// is left out.
std::vector<PointGroup> LinesOnBoard(const Cloud& cloud, const CloudEdges& board,
                                     const Target& target, double range_sigma_m);

}  // namespace rgbdt
