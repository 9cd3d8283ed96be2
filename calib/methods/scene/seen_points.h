#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <opencv2/core/mat.hpp>
#include <string>
#include <utility>
#include <vector>

#include "calib/camera/camera.h"
#include "calib/camera/project_points.h"
#include "calib/model/shot.h"

namespace rgbdt {

/// Indices of points that a camera may see from poses near `camera_from_lidar`: in its image, or
/// beside it within a tenth of its width. No more than `most`, evenly from all of them.
std::vector<std::size_t> PointsNearImage(const Camera& camera, const Rigid3& camera_from_lidar,
                                         const std::vector<Eigen::Vector3f>& points,
                                         std::size_t most);

/// Grey values of the shots' images as CV_32FC1, from 0 to 1: black is the 1st percentile of the
/// darkest image, white the 99th of the brightest, as images are to stay comparable. Throws
/// InputError for an image that is not the camera's.
std::vector<cv::Mat> GreyValues(const CameraSpec& camera, const std::vector<Shot>& shots);

/// Between the four pixels about a place of a CV_32FC1; the place must lie in the image.
inline float Interpolated(const cv::Mat& image, float u, float v) {
  const int x = std::min(static_cast<int>(u), image.cols - 2);
  const int y = std::min(static_cast<int>(v), image.rows - 2);
  const float a = u - static_cast<float>(x);
  const float b = v - static_cast<float>(y);
  const float* upper = image.ptr<float>(y) + x;
  const float* lower = image.ptr<float>(y + 1) + x;
  return (1 - b) * ((1 - a) * upper[0] + a * upper[1]) + b * ((1 - a) * lower[0] + a * lower[1]);
}

/// Whether a block's point is seen, in the image.
inline bool IsSeen(const Camera& camera, const PixelBlock& block, std::size_t i) {
  return block.inverse_range[i] > 0 && camera.Contains({block.u[i], block.v[i]});
}

/// Calls take(index, u, v) for each of the points that lies in the image [px], whatever stands
/// before it.
template <typename Take>
void ForEachSeen(const Camera& camera, const Rigid3& camera_from_lidar,
                 const std::vector<Eigen::Vector3f>& points, Take take) {
  const PointProjector projector(camera, camera_from_lidar);
  PixelBlock block;
  for (std::size_t first = 0; first < points.size(); first += PixelBlock::kSize) {
    const std::size_t count = std::min(PixelBlock::kSize, points.size() - first);
    projector.Project(&points[first], count, &block);
    for (std::size_t i = 0; i < count; ++i) {
      if (IsSeen(camera, block, i)) take(first + i, block.u[i], block.v[i]);
    }
  }
}

/// In words, for SceneFit::why_not; empty where `seen` of the `what` are enough.
std::string WhyTooFew(std::size_t seen, std::size_t least, const std::string& what);

}  // namespace rgbdt
