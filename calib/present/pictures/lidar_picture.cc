#include "calib/present/pictures/lidar_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

namespace rgbdt {
namespace {

constexpr int kWidth = 1060, kTitleHeight = 70, kChartHeight = 320, kLabelHeight = 100,
              kLabelRow = 38;
constexpr int kLeft = 130, kRight = 20, kDot = 7, kStroke = 3;
constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
constexpr double kTitleText = 1.3, kText = 1.0;
const cv::Scalar kInk = cv::Scalar::all(30), kPaper = cv::Scalar::all(255);
const cv::Scalar kFaint = cv::Scalar::all(215), kMark = {180, 90, 20};

struct Mark {
  std::string label;
  Estimate estimate;
};

struct Chart {
  std::string title;
  std::vector<Mark> marks;
};

Estimate Thousandfold(const Estimate& estimate) {
  return {1000 * estimate.value, 1000 * estimate.sigma};
}

Chart ByRing(const RangeErrors& errors) {
  Chart chart{"ranges by ring [mm]", {}};
  for (const auto& [ring, offset_m] : errors.rings) {
    chart.marks.push_back({std::to_string(ring), Thousandfold(offset_m)});
  }
  return chart;
}

Chart ByIntensity(const RangeErrors& errors) {
  Chart chart{"ranges by intensity, 1 the brightest [mm]", {}};
  for (const auto& [log2_intensity, offset_m] : errors.intensities) {
    chart.marks.push_back(
        {fmt::format("{:.2g}", std::exp2(log2_intensity)), Thousandfold(offset_m)});
  }
  return chart;
}

Chart ByEdge(const CameraReport& camera) {
  const std::string kind = "beam edge, ";
  Chart chart{"edges of a board, outwards [mrad]", {}};
  for (const Nuisance& nuisance : camera.nuisance) {
    const bool scatter = nuisance.name.find("scatter") != std::string::npos;
    if (nuisance.name.rfind(kind, 0) != 0 || scatter) continue;
    chart.marks.push_back({nuisance.name.substr(kind.size()), nuisance.estimate});
  }
  return chart;
}

void Write(const std::string& text, cv::Point at, double size, cv::Mat* picture) {
  cv::putText(*picture, text, at, kFont, size, kInk, kStroke, cv::LINE_AA);
}

int WidthOf(const std::string& text, double size) {
  int base = 0;
  return cv::getTextSize(text, kFont, size, kStroke, &base).width;
}

// 1, 2 or 5 times a power of ten: some four steps up to `most`.
double StepFor(double most) {
  const double rough = most / 2;
  const double decade = std::pow(10, std::floor(std::log10(rough)));
  for (const double step : {1.0, 2.0, 5.0}) {
    if (step * decade >= rough) return step * decade;
  }
  return 10 * decade;
}

cv::Mat Draw(const Chart& chart) {
  cv::Mat picture(kTitleHeight + kChartHeight + kLabelHeight, kWidth, CV_8UC3, kPaper);
  Write(chart.title, {10, 45}, kTitleText, &picture);
  double most = 1e-3;
  for (const auto& [label, estimate] : chart.marks) {
    most = std::max(most, std::abs(estimate.value) + estimate.sigma);
  }
  const cv::Rect field(kLeft, kTitleHeight, kWidth - kLeft - kRight, kChartHeight);
  const auto row_of = [&](double value) {
    return field.y + field.height / 2 -
           static_cast<int>(std::lround(0.46 * field.height * value / most));
  };
  const double step = StepFor(most);
  for (double value = -step * std::floor(most / step); value <= most + 1e-9; value += step) {
    const bool zero = std::abs(value) < 0.5 * step;
    cv::line(picture, {field.x, row_of(value)}, {field.br().x, row_of(value)}, zero ? kInk : kFaint,
             2);
    const std::string text = zero ? "0" : fmt::format("{:+g}", value);
    Write(text, {field.x - 14 - WidthOf(text, kText), row_of(value) + 10}, kText, &picture);
  }
  const double space = static_cast<double>(field.width) / static_cast<double>(chart.marks.size());
  std::array<int, 2> free_from{};  // where one label is too near the last it goes a row lower
  for (std::size_t i = 0; i < chart.marks.size(); ++i) {
    const auto& [label, estimate] = chart.marks[i];
    const int x = field.x + static_cast<int>(space * (static_cast<double>(i) + 0.5));
    cv::line(picture, {x, row_of(estimate.value - estimate.sigma)},
             {x, row_of(estimate.value + estimate.sigma)}, kMark, 4);
    cv::circle(picture, {x, row_of(estimate.value)}, kDot, kMark, cv::FILLED, cv::LINE_AA);
    const int width = WidthOf(label, kText);
    const int left = std::clamp(x - width / 2, 0, kWidth - width);
    for (std::size_t row = 0; row < free_from.size(); ++row) {
      if (left < free_from[row]) continue;
      Write(label, {left, field.br().y + 40 + static_cast<int>(row) * kLabelRow}, kText, &picture);
      free_from[row] = left + width + 16;
      break;
    }
  }
  return picture;
}

}  // namespace

cv::Mat LidarPicture(const CameraReport& camera) {
  if (!camera.calibration.range_errors) return {};
  const RangeErrors& errors = *camera.calibration.range_errors;
  cv::Mat picture;
  for (const Chart& chart : {ByRing(errors), ByIntensity(errors), ByEdge(camera)}) {
    if (chart.marks.empty()) continue;
    if (picture.empty()) {
      picture = Draw(chart);
    } else {
      cv::vconcat(picture, Draw(chart), picture);
    }
  }
  return picture;
}

}  // namespace rgbdt
