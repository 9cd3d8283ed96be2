#include "calib/detect/image/saturation.h"

#include <opencv2/core.hpp>

namespace rgbdt {

double SaturatedFrom(const Image& image) {
  if (image.pixels.depth() == CV_8U) return 250;
  double top = 0;
  cv::minMaxLoc(image.pixels, nullptr, &top);
  // Noise lets few pixels share the very brightest value, unless values end there.
  return cv::countNonZero(image.pixels == top) > 100 ? top : kNeverSaturated;
}

}  // namespace rgbdt
