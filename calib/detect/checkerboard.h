#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "calib/model/rig.h"

namespace rgbdt {

/// Finds the checkerboard's inner corners [px], sub-pixel, in the target's order up to a half turn
/// (row by row). Nothing where the board is not wholly seen. The image may be of either polarity,
/// and unevenly bright: what is stretched is the deviation from the local background.
std::optional<std::vector<Eigen::Vector2d>> FindCheckerboard(const cv::Mat& grey,
                                                             const Target& target);

}  // namespace rgbdt
