#include "calib/methods/edge_grid/edge_field.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace rgbdt {

cv::Mat EdgeImage(const cv::Mat& grey) {
  cv::Mat most;
  cv::Mat least;
  cv::dilate(grey, most, {});  // over the 3x3 pixels about each
  cv::erode(grey, least, {});
  cv::Mat edges;
  cv::max(cv::Mat(most - grey), cv::Mat(grey - least), edges);
  return edges;
}

cv::Mat InverseDistanceTransform(const cv::Mat& edges, double alpha, double gamma) {
  const auto factor = static_cast<float>(gamma);
  cv::Mat nearness = edges.clone();
  const auto pull = [&](int y, int x, int from_y, int from_x) {
    if (from_y < 0 || from_x < 0 || from_y >= edges.rows || from_x >= edges.cols) return;
    float& here = nearness.at<float>(y, x);
    here = std::max(here, factor * nearness.at<float>(from_y, from_x));
  };
  for (int y = 0; y < edges.rows; ++y) {
    for (int x = 0; x < edges.cols; ++x) {
      for (int dx = -1; dx <= 1; ++dx) pull(y, x, y - 1, x + dx);
      pull(y, x, y, x - 1);
    }
  }
  for (int y = edges.rows - 1; y >= 0; --y) {
    for (int x = edges.cols - 1; x >= 0; --x) {
      for (int dx = -1; dx <= 1; ++dx) pull(y, x, y + 1, x + dx);
      pull(y, x, y, x + 1);
    }
  }
  return alpha * edges + (1 - alpha) * nearness;
}

}  // namespace rgbdt
