#pragma once

#include <opencv2/core/mat.hpp>

namespace rgbdt {

/// E of the paper: of each pixel the largest difference to one of its 8 neighbours. CV_32FC1 to
/// CV_32FC1.
cv::Mat EdgeImage(const cv::Mat& grey);

/// D of the paper: alpha E + (1 - alpha) max over (i, j) of E_ij gamma^max(|x - i|, |y - j|), which
/// rewards being near an edge. In two passes, as of a distance transform: each step to one of 8
/// neighbours costs a factor of gamma, and the fewest steps are the larger of the two distances.
cv::Mat InverseDistanceTransform(const cv::Mat& edges, double alpha, double gamma);

}  // namespace rgbdt
