#include "calib/detect/image/internal/clipped.h"

#include <opencv2/imgproc.hpp>

namespace rgbdt {
namespace {

cv::Mat Bright(const cv::Mat& pixels) {
  cv::Mat mask;
  if (pixels.depth() != CV_8U) {
    double top = 0;
    cv::minMaxLoc(pixels, nullptr, &top);
    mask = pixels == top;
    // Noise lets few pixels share the very brightest value, unless values end there.
    if (cv::countNonZero(mask) <= 100) mask.setTo(0);
    return mask;
  }
  cv::inRange(pixels, cv::Scalar::all(0), cv::Scalar::all(249), mask);  // in all channels
  cv::bitwise_not(mask, mask);
  cv::dilate(mask, mask, cv::Mat::ones(3, 3, CV_8U));  // demosaicing reads the neighbours
  return mask;
}

cv::Mat Dark(const cv::Mat& pixels) {
  cv::Mat zero;
  cv::inRange(pixels, cv::Scalar::all(0), cv::Scalar::all(0), zero);
  cv::Mat share;
  cv::boxFilter(zero, share, CV_32F, {7, 7});
  return share > 0.1 * 255;
}

}  // namespace

cv::Mat Clipped(const Image& image) {
  cv::Mat clipped(image.pixels.size(), CV_8U, cv::Scalar(0));
  clipped.setTo(kClippedDark, Dark(image.pixels));
  clipped.setTo(kClippedBright, Bright(image.pixels));
  return clipped;
}

}  // namespace rgbdt
