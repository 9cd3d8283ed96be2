#include "calib/detect/image/internal/saddles.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <opencv2/imgproc.hpp>

#include "calib/detect/image/internal/grey_image.h"
#include "calib/model/statistics.h"

namespace rgbdt {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr int kReach = 2;         // a saddle is the strongest within 5x5 pixels
constexpr double kNoise = 5;      // at least this many times the median of |xy|
constexpr double kBalance = 0.1;  // eigenvalues' ratio at least: a square seen at up to 70 deg

struct SecondDerivative {
  float xx, xy, yy;
  float Saddleness() const { return xy * xy - xx * yy; }
};

SecondDerivative At(const cv::Mat& f, int y, int x) {
  const float* a = f.ptr<float>(y - 1) + x;
  const float* b = f.ptr<float>(y) + x;
  const float* c = f.ptr<float>(y + 1) + x;
  return {b[-1] - 2 * b[0] + b[1], 0.25F * (a[-1] - a[1] - c[-1] + c[1]), a[0] - 2 * b[0] + c[0]};
}

// Negative determinant of the second derivative; and the median of |xy|, from some of the pixels.
cv::Mat SaddlenessOf(const cv::Mat& f, float* typical) {
  cv::Mat out = cv::Mat::zeros(f.size(), CV_32F);
  std::vector<float> sizes;
  for (int y = 1; y + 1 < f.rows; ++y) {
    const float* a = f.ptr<float>(y - 1);
    const float* b = f.ptr<float>(y);
    const float* c = f.ptr<float>(y + 1);
    float* o = out.ptr<float>(y);
    for (int x = 1; x + 1 < f.cols; ++x) {
      const float xx = b[x - 1] - 2 * b[x] + b[x + 1];
      const float yy = a[x] - 2 * b[x] + c[x];
      const float xy = 0.25F * (a[x - 1] - a[x + 1] - c[x - 1] + c[x + 1]);
      o[x] = xy * xy - xx * yy;
    }
    for (int x = 1 + y % 7; x + 1 < f.cols; x += 7) sizes.push_back(std::abs(At(f, y, x).xy));
  }
  *typical = Median(std::move(sizes));
  return out;
}

bool IsPeak(const cv::Mat& s, int y, int x) {
  const float value = s.at<float>(y, x);
  for (int dy = -kReach; dy <= kReach; ++dy) {
    const float* row = s.ptr<float>(y + dy) + x;
    for (int dx = -kReach; dx <= kReach; ++dx) {
      // Of equals, the first in reading order.
      const bool before = dy < 0 || (dy == 0 && dx < 0);
      if (before ? row[dx] >= value : row[dx] > value) return false;
    }
  }
  return true;
}

double PeakOffset(float before, float at, float after) {
  const double bend = before - 2 * at + after;
  return bend < 0 ? std::clamp(0.5 * (before - after) / bend, -0.5, 0.5) : 0;
}

// On a ring round a checkerboard's corner brightness rises and falls twice. What remains after an
// even slope is taken away must be mostly that.
bool AlternatesTwice(const cv::Mat& blurred, const Eigen::Vector2d& place, double radius) {
  constexpr int kSteps = 16;
  std::array<double, kSteps> values{};
  std::array<std::complex<double>, 5> harmonics{};
  double energy = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double angle = 2 * kPi * i / kSteps;
    const double value = Interpolate(blurred, place.x() + radius * std::cos(angle),
                                     place.y() + radius * std::sin(angle));
    if (!std::isfinite(value)) return false;
    values[static_cast<std::size_t>(i)] = value;
    for (std::size_t k = 0; k < 3; ++k) {
      harmonics[k] += value * std::polar(1.0 / kSteps, -angle * static_cast<double>(k));
    }
  }
  for (const double value : values) {
    const double d = value - harmonics[0].real();
    energy += d * d / kSteps;
  }
  const double slope = 2 * std::norm(harmonics[1]);
  const double twice = 2 * std::norm(harmonics[2]);
  return twice > 0.7 * (energy - slope);
}

}  // namespace

std::vector<Saddle> FindSaddles(const cv::Mat& grey, double sigma) {
  std::vector<Saddle> saddles;
  if (grey.rows < 16 || grey.cols < 16) return saddles;
  cv::Mat blurred;
  cv::GaussianBlur(grey, blurred, {0, 0}, sigma);
  float typical = 0;
  const cv::Mat s = SaddlenessOf(blurred, &typical);
  const float least = std::max(static_cast<float>(kNoise * typical), 1e-6F);
  for (int y = kReach + 1; y + kReach + 1 < grey.rows; ++y) {
    const float* row = s.ptr<float>(y);
    for (int x = kReach + 1; x + kReach + 1 < grey.cols; ++x) {
      if (row[x] < least * least || !IsPeak(s, y, x)) continue;
      const SecondDerivative d = At(blurred, y, x);
      const double mean = 0.5 * (d.xx + d.yy);
      const double root = std::hypot(0.5 * (d.xx - d.yy), d.xy);
      const double rise = mean + root;  // eigenvalues: rise > 0 > -fall
      const double fall = root - mean;
      if (std::min(rise, fall) < kBalance * std::max(rise, fall)) continue;
      Saddle saddle;
      saddle.place = {x + PeakOffset(row[x - 1], row[x], row[x + 1]),
                      y + PeakOffset(s.at<float>(y - 1, x), row[x], s.at<float>(y + 1, x))};
      if (!AlternatesTwice(blurred, saddle.place, 2.2 * sigma)) continue;
      saddle.hessian = Eigen::Vector3d(d.xx, std::sqrt(2.0) * d.xy, d.yy).normalized();
      saddle.strength = std::sqrt(static_cast<double>(row[x]));
      // Along an edge the second derivative is zero.
      const double steepest = 0.5 * std::atan2(2.0 * d.xy, static_cast<double>(d.xx) - d.yy);
      const double half = std::atan(std::sqrt(rise / fall));
      for (const int k : {0, 1}) {
        const double angle = steepest + (k == 0 ? half : -half);
        saddle.edges[static_cast<std::size_t>(k)] = angle - kPi * std::floor(angle / kPi);
      }
      saddles.push_back(saddle);
    }
  }
  return saddles;
}

}  // namespace rgbdt
