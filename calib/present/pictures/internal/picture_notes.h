#pragma once

// What is written on a picture of a cloud.

#include <opencv2/core/mat.hpp>
#include <vector>

#include "calib/present/pictures/cloud_picture.h"
#include "calib/present/pictures/internal/viewpoint.h"

namespace rgbdt {

/// Top left: the title, the number of points and how many of them have the colour.
void DrawCaption(const DrawOptions& options, CloudColour colour, const std::vector<bool>& coloured,
                 cv::Mat* picture);

/// Bottom left: which way the LIDAR frame's axes point (x forward, red; y left, green; z up, blue).
/// Where the LIDAR itself lies in the picture, a ring marks it.
void DrawAxes(const Viewpoint& viewpoint, bool white_background, cv::Mat* picture);

}  // namespace rgbdt
