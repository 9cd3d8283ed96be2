#include "calib/detect/image/internal/grey_image.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <vector>

#include "calib/model/statistics.h"

namespace rgbdt {
namespace {

// Median distance of two neighbouring pixels: noise and fine texture.
float TypicalStep(const cv::Mat& grey) {
  std::vector<float> steps;
  for (int y = 0; y < grey.rows; y += 3) {
    const float* row = grey.ptr<float>(y);
    for (int x = 0; x + 1 < grey.cols; x += 5) steps.push_back(std::abs(row[x + 1] - row[x]));
  }
  return Median(std::move(steps));
}

std::array<float, 8> Neighbours(const cv::Mat& grey, int y, int x) {
  const float* above = grey.ptr<float>(y - 1) + x;
  const float* row = grey.ptr<float>(y) + x;
  const float* below = grey.ptr<float>(y + 1) + x;
  return {above[-1], above[0], above[1], row[-1], row[1], below[-1], below[0], below[1]};
}

float RepairedValue(const cv::Mat& grey, int y, int x, float limit) {
  std::array<float, 8> around = Neighbours(grey, y, x);
  const float value = grey.at<float>(y, x);
  std::sort(around.begin(), around.end());
  // Beyond all neighbours but one: two dead pixels may touch.
  const bool out = value > around[6] + limit || value < around[1] - limit;
  // A fine bright line's end also stands out; a dead pixel does so by more than they differ.
  const float spread = around[6] - around[1];
  const float middle = 0.5F * (around[3] + around[4]);
  return out && std::abs(value - middle) > 2 * spread ? middle : value;
}

// Of lines of pixels one that stands out from both beside it, all along and on one side.
class LineCount {
 public:
  void Add(float value, float before, float after, float limit) {
    above_ += static_cast<int>(value > before + limit && value > after + limit);
    below_ += static_cast<int>(value < before - limit && value < after - limit);
  }
  bool IsDead(int length) const { return 10 * std::max(above_, below_) > 9 * length; }

 private:
  int above_ = 0, below_ = 0;
};

// Columns and rows that a readout lost.
void RepairDeadLines(float limit, cv::Mat* grey) {
  std::vector<LineCount> columns(static_cast<std::size_t>(grey->cols));
  std::vector<LineCount> rows(static_cast<std::size_t>(grey->rows));
  for (int y = 1; y + 1 < grey->rows; ++y) {
    const float* row = grey->ptr<float>(y);
    const float* above = grey->ptr<float>(y - 1);
    const float* below = grey->ptr<float>(y + 1);
    LineCount& line = rows[static_cast<std::size_t>(y)];
    for (int x = 1; x + 1 < grey->cols; ++x) {
      columns[static_cast<std::size_t>(x)].Add(row[x], row[x - 1], row[x + 1], limit);
      line.Add(row[x], above[x], below[x], limit);
    }
  }
  for (int x = 1; x + 1 < grey->cols; ++x) {
    if (!columns[static_cast<std::size_t>(x)].IsDead(grey->rows - 2)) continue;
    grey->col(x) = 0.5 * (grey->col(x - 1) + grey->col(x + 1));
  }
  for (int y = 1; y + 1 < grey->rows; ++y) {
    if (!rows[static_cast<std::size_t>(y)].IsDead(grey->cols - 2)) continue;
    grey->row(y) = 0.5 * (grey->row(y - 1) + grey->row(y + 1));
  }
}

}  // namespace

std::string WhyImageIsUseless(const cv::Mat& grey) {
  if (grey.empty()) return "the image is empty";
  double low = 0;
  double high = 0;
  cv::minMaxLoc(grey, &low, &high);
  if (!(high > low)) return "the image is constant";
  constexpr double kMost = 0.5;
  const auto share = [&](double value) {
    return cv::countNonZero(grey == value) / static_cast<double>(grey.total());
  };
  const auto text = [](double part, const char* end) {
    return "the image is saturated: " + std::to_string(std::lround(100 * part)) +
           "% of its pixels are at the " + end + " end";
  };
  if (share(high) > kMost) return text(share(high), "upper");
  if (share(low) > kMost) return text(share(low), "lower");
  return "";
}

cv::Mat RepairDeadPixels(const cv::Mat& given) {
  // Of two pixels with noise sigma, the distance's median is 0.95 sigma: 8 sigma here.
  const float limit = 8 * std::max(TypicalStep(given), 1e-6F);
  cv::Mat grey = given.clone();
  RepairDeadLines(limit, &grey);
  cv::Mat out = grey.clone();
  std::vector<int> far_from(static_cast<std::size_t>(grey.cols));  // of four neighbours, a row's
  for (int y = 1; y + 1 < grey.rows; ++y) {
    const float* row = grey.ptr<float>(y);
    const float* above = grey.ptr<float>(y - 1);
    const float* below = grey.ptr<float>(y + 1);
    // Quick, many at once: most pixels lie between their neighbours.
    int* far = far_from.data();
    for (int x = 1; x + 1 < grey.cols; ++x) {
      const float value = row[x];
      far[x] = static_cast<int>(std::abs(value - row[x - 1]) > limit) +
               static_cast<int>(std::abs(value - row[x + 1]) > limit) +
               static_cast<int>(std::abs(value - above[x]) > limit) +
               static_cast<int>(std::abs(value - below[x]) > limit);
    }
    for (int x = 1; x + 1 < grey.cols; ++x) {
      if (far[x] >= 3) out.at<float>(y, x) = RepairedValue(grey, y, x, limit);
    }
  }
  return out;
}

float Interpolate(const cv::Mat& grey, double x, double y) {
  if (!(x >= 0 && y >= 0 && x <= grey.cols - 1 && y <= grey.rows - 1)) {
    return std::numeric_limits<float>::quiet_NaN();
  }
  const int left = std::min(static_cast<int>(x), grey.cols - 2);
  const int top = std::min(static_cast<int>(y), grey.rows - 2);
  const auto fx = static_cast<float>(x - left);
  const auto fy = static_cast<float>(y - top);
  const float* a = grey.ptr<float>(top) + left;
  const float* b = grey.ptr<float>(top + 1) + left;
  return (1 - fy) * ((1 - fx) * a[0] + fx * a[1]) + fy * ((1 - fx) * b[0] + fx * b[1]);
}

}  // namespace rgbdt
