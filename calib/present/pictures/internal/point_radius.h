#pragma once

// How large a point is to be drawn.

#include <Eigen/Core>
#include <vector>

namespace rgbdt {

/// Radius [m] of the disc that closes the gap from each point to its neighbours, seen from the
/// LIDAR in the origin; at least what the spacing of the beams asks for, at most some times that:
/// lines on ground that is seen at a grazing angle stay lines. 0 for points that are not finite.
std::vector<float> PointRadii(const std::vector<Eigen::Vector3f>& points);

}  // namespace rgbdt
