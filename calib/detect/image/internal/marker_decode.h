#pragma once

#include <Eigen/Core>
#include <array>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "calib/model/markers.h"

namespace rgbdt {

/// A marker in an image.
struct SeenMarker {
  int id = 0;
  /// [px], to a pixel or so: the marker's own top left, top right, bottom right, bottom left.
  std::array<Eigen::Vector2d, 4> corners;
};

/// Markers of a family in grey values (CV_32FC1, finite, any unit), by OpenCV's aruco; with none
/// that are dark on light, of exchanged polarity. Ordered by number, each number once: the largest.
/// Where fewer than `enough` are seen, the image is looked at twice as large, too.
std::vector<SeenMarker> DecodeMarkers(const cv::Mat& grey, const MarkerFamily& family,
                                      int border_bits, std::size_t enough);

}  // namespace rgbdt
