#include "calib/detect/image/internal/colour_planes.h"

#include <opencv2/core.hpp>

#include "calib/camera/pixels.h"

namespace rgbdt {

std::vector<cv::Mat> ColourPlanes(const Image& image) {
  constexpr float kDark = 30;  // of the sum of three [DN]: the colour of what is darker is noise
  if (image.format == PixelFormat::kMono8 || image.format == PixelFormat::kMono16) return {};
  const cv::Mat bgr = ToBgr(image);
  cv::Mat red_blue(bgr.size(), CV_32FC1);
  cv::Mat green(bgr.size(), CV_32FC1);
  for (int y = 0; y < bgr.rows; ++y) {
    const auto* row = bgr.ptr<cv::Vec3b>(y);
    for (int x = 0; x < bgr.cols; ++x) {
      const auto b = static_cast<float>(row[x][0]);
      const auto g = static_cast<float>(row[x][1]);
      const auto r = static_cast<float>(row[x][2]);
      const float sum = r + g + b + kDark;
      red_blue.at<float>(y, x) = (r - b) / sum;
      green.at<float>(y, x) = (g - 0.5F * (r + b)) / sum;
    }
  }
  return {red_blue, green};
}

}  // namespace rgbdt
