#pragma once

// Which colour a point has in a picture, and the legend.

#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "calib/present/pictures/cloud_picture.h"

namespace rgbdt {

/// Which value is which colour.
struct ColourScale {
  bool used = false;  ///< false: colours mean nothing but themselves
  double low = 0, high = 1;
  std::string unit;  ///< "C" (drawn with its degree sign), "counts", "intensity"
  cv::Mat table;     ///< 256 colours, CV_8UC3
};

struct PointColours {
  std::vector<cv::Vec3b> bgr;
  std::vector<bool> coloured;  ///< false: grey, for lack of what was asked for
  ColourScale scale;
};

PointColours ColourPoints(const RgbdtCloud& cloud, CloudColour colour, bool white_background);

/// Draws the scale as a bar with numbers at the right edge.
void DrawLegend(const ColourScale& scale, bool white_background, cv::Mat* picture);

/// Of text and lines on the picture.
cv::Scalar TextColour(bool white_background);

/// Draws small text with its baseline's left end at `at`.
void DrawText(const std::string& text, cv::Point at, bool white_background, cv::Mat* picture);

}  // namespace rgbdt
