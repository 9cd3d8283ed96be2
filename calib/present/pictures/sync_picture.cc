#include "calib/present/pictures/sync_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

namespace rgbdt {
namespace {

constexpr int kChartWidth = 1000, kChartHeight = 360, kFieldLeft = 140, kFieldTop = 60;
constexpr int kFieldRight = 970, kFieldBottom = 310;
const cv::Scalar kChartInk = cv::Scalar::all(30), kGrid = cv::Scalar::all(215);
const cv::Scalar kPointColour = {180, 90, 20};

void Label(const std::string& text, cv::Point at, cv::Mat* picture) {
  cv::putText(*picture, text, at, cv::FONT_HERSHEY_SIMPLEX, 0.7, kChartInk, 2, cv::LINE_AA);
}

cv::Mat ChartOf(const SyncedCamera& camera) {
  cv::Mat picture(kChartHeight, kChartWidth, CV_8UC3, cv::Scalar::all(255));
  const double mean = camera.time_offset_s.value;
  Label(fmt::format("{}: time offset less its mean of {:.3f} ms [us], over time [s]", camera.camera,
                    1e3 * mean),
        {20, 35}, &picture);
  double most = 1e-5;
  for (const OffsetAt& at : camera.offsets) {
    most = std::max(most, std::abs(at.offset_s.value - mean) + at.offset_s.sigma);
  }
  const double last = std::max(1.0, camera.offsets.back().seconds);
  const auto place = [&](double seconds, double offset) {
    return cv::Point(
        kFieldLeft + static_cast<int>(std::lround((kFieldRight - kFieldLeft) * seconds / last)),
        static_cast<int>(std::lround(0.5 * (kFieldTop + kFieldBottom) -
                                     0.5 * (kFieldBottom - kFieldTop) * offset / most)));
  };
  for (const double level : {-most, 0.0, most}) {
    cv::line(picture, place(0, level), place(last, level), kGrid, 2);
    Label(fmt::format("{:+.0f}", 1e6 * level), place(0, level) + cv::Point(-120, 8), &picture);
  }
  for (const OffsetAt& at : camera.offsets) {
    const double off = at.offset_s.value - mean;
    cv::line(picture, place(at.seconds, off - at.offset_s.sigma),
             place(at.seconds, off + at.offset_s.sigma), kPointColour, 3, cv::LINE_AA);
    cv::circle(picture, place(at.seconds, off), 6, kPointColour, cv::FILLED, cv::LINE_AA);
  }
  Label("0", {kFieldLeft, kFieldBottom + 35}, &picture);
  Label(fmt::format("{:.0f}", last), {kFieldRight - 30, kFieldBottom + 35}, &picture);
  return picture;
}

}  // namespace

cv::Mat SyncPicture(const SyncResult& result) {
  cv::Mat picture;
  for (const SyncedCamera& camera : result.cameras) {
    if (!camera.offsets.empty()) {
      if (picture.empty()) {
        picture = ChartOf(camera);
      } else {
        cv::vconcat(picture, ChartOf(camera), picture);
      }
    }
  }
  return picture;
}

}  // namespace rgbdt
