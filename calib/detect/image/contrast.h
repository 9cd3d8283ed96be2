#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "calib/model/rig.h"

namespace rgbdt {

/// How much the target's squares of one colour differ from those of the other, in the image's units
/// (DN or counts): the median over neighbouring squares, so that a glow over the board, a hand or
/// dead pixels do not count. `grey` is CV_32FC1, `corners` the inner corners [px] in the target's
/// order or half a turn off it, NaN where one was not seen. 0 where no two squares lie in the
/// image.
double SquareContrast(const cv::Mat& grey, const Target& target,
                      const std::vector<Eigen::Vector2d>& corners);

}  // namespace rgbdt
