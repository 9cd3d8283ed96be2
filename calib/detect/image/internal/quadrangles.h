#pragma once

#include <Eigen/Core>
#include <array>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "calib/camera/camera.h"

namespace rgbdt {

/// Four lines, straight in space, round something brighter or darker than what is about it.
struct Quadrangle {
  /// Where its corners look: unit directions in camera axes, clockwise as seen. They may lie
  /// outside the image.
  std::array<Eigen::Vector3d, 4> corners;
  /// Of each line, from a corner to the next, the part that was seen [px].
  std::array<std::array<Eigen::Vector2d, 2>, 4> seen;
  double seen_px = 0;  ///< length of these parts
};

/// Convex quadrangles in one plane of an image (CV_32FC1, any unit), those of which most is seen
/// first, at most twenty: outlines of what lies above or below one of some levels, in the image
/// shrunk to some 800 px. Something that covers a part of a side, and corners outside the image, do
/// no harm; each of the four sides must be seen in part. Places are good to some pixels.
std::vector<Quadrangle> FindQuadrangles(const cv::Mat& plane, const Camera& camera);

/// Sigma [px] of `seen` across the line.
double QuadrangleSigmaPx(const cv::Mat& grey);

}  // namespace rgbdt
