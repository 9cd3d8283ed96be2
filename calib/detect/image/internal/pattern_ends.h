#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "calib/detect/image/internal/board_map.h"
#include "calib/model/rig.h"

namespace rgbdt {

/// Why a pattern of which only a part is seen may lie a square or more beside where `map` puts it;
/// empty: it does not. Corners alone do not tell, they are like themselves two squares farther on.
/// Along width and along height one end of the pattern must be seen: its outermost squares
/// alternate between light and dark there, and what lies beyond does not. No end that is seen may
/// go on beyond. `grey` is CV_32FC1; `corners`: the inner corners, NaN where one was not seen;
/// `contrast`: half of light minus dark, positive where the first corner's square (see
/// CornerFit::contrast) is the lighter one.
std::string WhyPatternMayBeShifted(const cv::Mat& grey, const BoardMap& map, const Target& target,
                                   const std::vector<Eigen::Vector2d>& corners, double contrast);

}  // namespace rgbdt
