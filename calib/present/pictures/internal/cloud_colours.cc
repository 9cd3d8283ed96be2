#include "calib/present/pictures/internal/cloud_colours.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "calib/model/text.h"

namespace rgbdt {
namespace {

constexpr double kZeroCelsius = 273.15;
constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;

// 256 colours from `first` of 256 on: what is too dark would not stand out from the background.
cv::Mat Table(int colour_map, int first) {
  cv::Mat grey(1, 256, CV_8UC1);
  for (int i = 0; i < 256; ++i) {
    grey.at<unsigned char>(i) = static_cast<unsigned char>(first + i * (255 - first) / 255);
  }
  cv::Mat table;
  cv::applyColorMap(grey, table, colour_map);
  return table;
}

// Sets low and high so that a few outliers do not take the whole range.
void SetRange(std::vector<float> values, ColourScale* scale) {
  values.erase(std::remove_if(values.begin(), values.end(),
                              [](float value) { return !std::isfinite(value); }),
               values.end());
  if (values.empty()) return;
  const auto percentile = [&](double fraction) {
    const std::size_t k =
        static_cast<std::size_t>(std::lround(fraction * static_cast<double>(values.size() - 1)));
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(k), values.end());
    return static_cast<double>(values[k]);
  };
  scale->low = percentile(0.01);
  scale->high = percentile(0.99);
  if (!(scale->high > scale->low)) scale->high = scale->low + 1;
}

cv::Vec3b Look(const ColourScale& scale, double value) {
  const double fraction = (value - scale.low) / (scale.high - scale.low);
  return scale.table.at<cv::Vec3b>(
      static_cast<int>(std::lround(std::clamp(fraction, 0.0, 1.0) * 255)));
}

// Grey and unobtrusive, on either ground; brighter where more light came back.
cv::Vec3b Grey(float intensity, bool white_background) {
  const double light = std::isfinite(intensity) ? std::sqrt(std::clamp(intensity, 0.f, 1.f)) : 0.3;
  const double value = white_background ? 205 - 60 * light : 56 + 64 * light;
  return cv::Vec3b::all(static_cast<unsigned char>(value));
}

std::vector<float> Celsius(const std::vector<float>& kelvin) {
  std::vector<float> celsius;
  celsius.reserve(kelvin.size());
  for (const float k : kelvin) celsius.push_back(static_cast<float>(k - kZeroCelsius));
  return celsius;
}

// The values that the colour stands for, and the scale that fits them.
std::vector<float> Values(const RgbdtCloud& cloud, CloudColour colour, ColourScale* scale) {
  scale->used = true;
  std::vector<float> values;
  if (colour == CloudColour::kIntensity) {
    values = cloud.intensity;
    scale->unit = "intensity";
    scale->table = Table(cv::COLORMAP_VIRIDIS, 0);
  } else {
    const bool kelvin = std::any_of(cloud.temperature_k.begin(), cloud.temperature_k.end(),
                                    [](float t) { return std::isfinite(t); });
    values = kelvin ? Celsius(cloud.temperature_k) : cloud.thermal_counts;
    scale->unit = kelvin ? "C" : "counts";
    scale->table = Table(cv::COLORMAP_INFERNO, 36);
  }
  SetRange(values, scale);
  return values;
}

// 1, 2 or 5 times a power of ten, such that some five steps fit into the range.
double RoundStep(double range) {
  const double power = std::pow(10, std::floor(std::log10(range / 4)));
  const double factor = range / 4 / power;
  return power * (factor < 1.5 ? 1 : factor < 3.5 ? 2 : factor < 7.5 ? 5 : 10);
}

// With as many decimals as the step between two of them needs.
std::string Label(double value, double step) {
  const int decimals = std::clamp(static_cast<int>(-std::floor(std::log10(step) + 1e-9)), 0, 6);
  return Fixed(std::abs(value) < 1e-9 * step ? 0 : value, decimals);
}

// OpenCV's fonts have no degree sign: a small circle is one.
void DrawUnit(const std::string& unit, cv::Point at, bool white_background, cv::Mat* picture) {
  if (unit == "C") {
    cv::circle(*picture, {at.x + 4, at.y - 11}, 3, TextColour(white_background), 1, cv::LINE_AA);
    at.x += 10;
  }
  DrawText(unit, at, white_background, picture);
}

// A pane that what is written on it stands out from.
void Dim(const cv::Rect& pane, bool white_background, cv::Mat* picture) {
  cv::Mat part = (*picture)(pane & cv::Rect({0, 0}, picture->size()));
  part = 0.35 * part + cv::Scalar::all(white_background ? 166 : 10);
}

}  // namespace

PointColours ColourPoints(const RgbdtCloud& cloud, CloudColour colour, bool white_background) {
  PointColours colours;
  const std::size_t n = cloud.size();
  colours.bgr.reserve(n);
  colours.coloured.reserve(n);
  std::vector<float> values;
  if (colour != CloudColour::kRgb) values = Values(cloud, colour, &colours.scale);
  for (std::size_t i = 0; i < n; ++i) {
    const auto& rgb = cloud.rgb[i];
    const bool coloured =
        colour == CloudColour::kRgb ? (rgb[0] | rgb[1] | rgb[2]) != 0 : std::isfinite(values[i]);
    colours.coloured.push_back(coloured);
    if (!coloured) {
      colours.bgr.push_back(Grey(cloud.intensity[i], white_background));
    } else if (colour == CloudColour::kRgb) {
      colours.bgr.emplace_back(rgb[2], rgb[1], rgb[0]);
    } else {
      colours.bgr.push_back(Look(colours.scale, values[i]));
    }
  }
  return colours;
}

cv::Scalar TextColour(bool white_background) {
  return white_background ? cv::Scalar::all(20) : cv::Scalar::all(235);
}

void DrawText(const std::string& text, cv::Point at, bool white_background, cv::Mat* picture) {
  // On a rim of the other colour it can be read whatever lies behind.
  cv::putText(*picture, text, at, kFont, 0.6, TextColour(!white_background), 4, cv::LINE_AA);
  cv::putText(*picture, text, at, kFont, 0.6, TextColour(white_background), 1, cv::LINE_AA);
}

void DrawLegend(const ColourScale& scale, bool white_background, cv::Mat* picture) {
  constexpr int kWidth = 18;
  const int height = picture->rows / 2;
  const int left = picture->cols - 110, top = picture->rows / 4;
  // A picture too small for a legend goes without.
  if (!scale.used || left < picture->cols / 2 || height < 60) return;
  Dim(cv::Rect(left - 14, top - 40, 124, height + 58), white_background, picture);
  for (int y = 0; y < height; ++y) {
    const int index = 255 - y * 255 / (height - 1);
    const cv::Vec3b c = scale.table.at<cv::Vec3b>(index);
    cv::line(*picture, {left, top + y}, {left + kWidth, top + y}, cv::Scalar(c[0], c[1], c[2]));
  }
  cv::rectangle(*picture, cv::Rect(left - 1, top - 1, kWidth + 3, height + 2),
                TextColour(white_background));
  const double range = scale.high - scale.low, step = RoundStep(range);
  for (double value = std::ceil(scale.low / step) * step; value <= scale.high; value += step) {
    const double fraction = (value - scale.low) / range;
    const int y = top + static_cast<int>((1 - fraction) * (height - 1));
    cv::line(*picture, {left + kWidth + 2, y}, {left + kWidth + 6, y},
             TextColour(white_background));
    DrawText(Label(value, step), {left + kWidth + 10, y + 6}, white_background, picture);
  }
  DrawUnit(scale.unit, {left - 2, top - 14}, white_background, picture);
}

}  // namespace rgbdt
