#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "calib/model/map_cloud.h"

namespace rgbdt {

/// A map from above (8-bit BGR), x to the right, y up: each pixel the highest voxel under it, in
/// its own colour where a camera saw it, else by height from blue to yellow (2nd to 98th
/// percentile); `way` as a red line, `loops` (where it came back to a place) as green rings. A
/// pixel is a voxel, or several where the picture would be larger than `most_px`. Throws InputError
/// for a map without points.
cv::Mat MapPicture(const MapCloud& map, const std::vector<Eigen::Vector3d>& way,
                   const std::vector<Eigen::Vector3d>& loops = {}, int most_px = 2400);

}  // namespace rgbdt
