#include "calib/present/frames/image_frame.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "calib/camera/pixels.h"
#include "calib/files/image_files.h"
#include "calib/fuse/radiometry.h"
#include "calib/present/layout/frame.h"

namespace rgbdt {
namespace {

constexpr int kThumbWidth = 240;  // [px]
constexpr int kThumbQuality = 75;

// 8-bit pixels as they are shown; of a thermal image black and white stand for these temperatures.
struct Picture {
  cv::Mat pixels;
  double min_k = std::numeric_limits<double>::quiet_NaN();
  double max_k = std::numeric_limits<double>::quiet_NaN();
};

bool IsThermal(const Image& image) {
  return image.format == PixelFormat::kMono16 ||
         (image.format == PixelFormat::kMono8 && image.radiometry.kind != Radiometry::Kind::kNone);
}

cv::Mat Shrunk(const cv::Mat& pixels, int width) {
  if (pixels.cols <= width) return pixels;
  const double scale = static_cast<double>(width) / pixels.cols;
  const int height = std::max(1, static_cast<int>(std::lround(scale * pixels.rows)));
  cv::Mat shrunk;
  cv::resize(pixels, shrunk, {width, height}, 0, 0, cv::INTER_AREA);
  return shrunk;
}

// Stretched once it is small: its noise is less then.
Picture ThermalPicture(const Image& image, int width) {
  cv::Mat counts;
  Shrunk(image.pixels, width).convertTo(counts, CV_32F);
  const auto limits = StretchLimits(counts);
  Picture picture{Stretch(counts, limits)};
  const double min_k = KelvinOf(image.radiometry, limits.first);
  const double max_k = KelvinOf(image.radiometry, limits.second);
  if (!std::isfinite(min_k) || !std::isfinite(max_k)) return picture;  // a scale has both ends
  picture.min_k = min_k;
  picture.max_k = max_k;
  return picture;
}

Picture PictureOf(const Image& image, int width) {
  CheckPixels(image);
  if (IsThermal(image)) return ThermalPicture(image, width);
  if (image.format == PixelFormat::kMono8) return {Shrunk(image.pixels, width)};
  return {Shrunk(ToBgr(image), width)};
}

}  // namespace

std::string ImageFrame(const Image& image, const std::string& view, bool ack,
                       const ImageFrameOptions& options) {
  const Picture picture = PictureOf(image, options.max_width);
  FrameWriter frame({{"type", "image"},
                     {"camera", image.camera},
                     {"view", view},
                     {"utime", image.utime},
                     {"width", image.pixels.cols},
                     {"height", image.pixels.rows},
                     {"min_k", FiniteOrNull(picture.min_k)},
                     {"max_k", FiniteOrNull(picture.max_k)},
                     {"ack", ack}});
  frame.AddBytes("jpeg", EncodeJpeg(picture.pixels, options.quality));
  return frame.Finish();
}

std::string ThumbFrame(const Image& image, const std::string& view) {
  const cv::Mat pixels = PictureOf(image, kThumbWidth).pixels;
  FrameWriter frame({{"type", "thumb"},
                     {"view", view},
                     {"camera", image.camera},
                     {"width", pixels.cols},
                     {"height", pixels.rows}});
  frame.AddBytes("jpeg", EncodeJpeg(pixels, kThumbQuality));
  return frame.Finish();
}

}  // namespace rgbdt
