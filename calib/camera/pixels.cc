#include "calib/camera/pixels.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "calib/model/errors.h"
#include "calib/model/statistics.h"

namespace rgbdt {
namespace {

std::string Size(int width, int height) {
  return std::to_string(width) + "x" + std::to_string(height);
}

std::string Where(const std::string& camera) { return "image of camera \"" + camera + "\": "; }

// Whether pixels can be of that format at all: OpenCV's own complaint would name no camera.
bool Fits(PixelFormat format, const cv::Mat& pixels) {
  switch (format) {
    case PixelFormat::kMono16:
      return pixels.type() == CV_16UC1;
    case PixelFormat::kBgr8:
      return pixels.type() == CV_8UC3;
    case PixelFormat::kMono8:
    case PixelFormat::kBayerRg8:
    case PixelFormat::kBayerGr8:
    case PixelFormat::kBayerGb8:
    case PixelFormat::kBayerBg8:
      return pixels.type() == CV_8UC1;
    case PixelFormat::kJpeg:
    case PixelFormat::kPng:
      break;
  }
  return false;
}

}  // namespace

float Percentile(const cv::Mat& grey, double fraction) {
  std::vector<float> values;
  values.reserve(grey.total() / 7 + 1);
  for (std::size_t i = 0; i < grey.total(); i += 7) {
    values.push_back(
        grey.at<float>(static_cast<int>(i) / grey.cols, static_cast<int>(i) % grey.cols));
  }
  const auto k = static_cast<std::size_t>(fraction * static_cast<double>(values.size() - 1));
  return Nth(std::move(values), k);
}

std::pair<float, float> StretchLimits(const cv::Mat& grey) {
  const float low = Percentile(grey, 0.01);
  return {low, std::max(Percentile(grey, 0.99), low + 1e-3F)};
}

cv::Mat Stretch(const cv::Mat& grey) { return Stretch(grey, StretchLimits(grey)); }

cv::Mat Stretch(const cv::Mat& grey, const std::pair<float, float>& limits) {
  const auto [low, high] = limits;
  cv::Mat out;
  grey.convertTo(out, CV_8U, 255.0 / (high - low), -255.0 * low / (high - low));
  return out;
}

void CheckImage(const CameraSpec& camera, const Image& image) {
  const std::string where = Where(camera.name);
  if (image.pixels.cols != camera.width || image.pixels.rows != camera.height) {
    throw InputError(where + "size is " + Size(image.pixels.cols, image.pixels.rows) +
                     ", the rig file says " + Size(camera.width, camera.height));
  }
  if (camera.kind == CameraKind::kThermal && image.pixels.channels() != 1) {
    throw InputError(where + "a thermal image has one channel, this one has " +
                     std::to_string(image.pixels.channels()) +
                     "; save counts, not a coloured picture");
  }
  CheckPixels(image);
}

void CheckPixels(const Image& image) {
  if (!image.pixels.empty() && Fits(image.format, image.pixels)) return;
  throw InputError(Where(image.camera) + std::to_string(image.pixels.channels()) + " channels of " +
                   std::to_string(8 * image.pixels.elemSize1()) + " bits, " +
                   Size(image.pixels.cols, image.pixels.rows) +
                   ", do not make an image of format " +
                   std::to_string(static_cast<int>(image.format)) + " (image_t.lcm)");
}

cv::Mat ToBgr(const Image& image) {
  cv::Mat out;
  switch (image.format) {
    case PixelFormat::kMono8:
      cv::cvtColor(image.pixels, out, cv::COLOR_GRAY2BGR);
      return out;
    case PixelFormat::kMono16: {
      cv::Mat grey;
      image.pixels.convertTo(grey, CV_32F);
      cv::cvtColor(Stretch(grey), out, cv::COLOR_GRAY2BGR);
      return out;
    }
    // OpenCV names a mosaic by its second row's second and third pixel: its BG is GenICam's RG.
    case PixelFormat::kBayerRg8:
      cv::cvtColor(image.pixels, out, cv::COLOR_BayerBG2BGR);
      return out;
    case PixelFormat::kBayerGr8:
      cv::cvtColor(image.pixels, out, cv::COLOR_BayerGB2BGR);
      return out;
    case PixelFormat::kBayerGb8:
      cv::cvtColor(image.pixels, out, cv::COLOR_BayerGR2BGR);
      return out;
    case PixelFormat::kBayerBg8:
      cv::cvtColor(image.pixels, out, cv::COLOR_BayerRG2BGR);
      return out;
    case PixelFormat::kBgr8:
      return image.pixels;
    case PixelFormat::kJpeg:
    case PixelFormat::kPng:
      break;
  }
  throw InputError(Where(image.camera) + "compressed pixels were not decoded");
}

cv::Mat ToGrey(const Image& image) {
  cv::Mat out;
  if (image.format == PixelFormat::kMono8 || image.format == PixelFormat::kMono16) {
    image.pixels.convertTo(out, CV_32F);
    return out;
  }
  cv::Mat grey;
  cv::cvtColor(ToBgr(image), grey, cv::COLOR_BGR2GRAY);
  grey.convertTo(out, CV_32F);
  return out;
}

}  // namespace rgbdt
