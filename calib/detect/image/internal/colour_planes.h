#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "calib/model/image.h"

namespace rgbdt {

/// What an image shows of colour, whatever the light: red less blue, and green less the mean of
/// both, each over the sum of all three. CV_32FC1, -1 to 1. Nothing of an image in grey.
std::vector<cv::Mat> ColourPlanes(const Image& image);

}  // namespace rgbdt
