#include "calib/methods/mutual_information/joint_histogram.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace rgbdt {
namespace {

// -sum p log p of weights whose sum is `total`.
double EntropyOf(const double* weights, std::size_t count, double total) {
  double sum = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (weights[i] > 0) sum += weights[i] * std::log(weights[i]);
  }
  return std::log(total) - sum / total;
}

double Silverman(double sum, double squares, double count) {
  const double mean = sum / count;
  const double variance = std::max(0.0, squares / count - mean * mean);
  return 1.06 * std::sqrt(variance) * std::pow(count, -0.2);
}

}  // namespace

Entropies EntropiesOf(const cv::Mat& joint) {
  std::vector<double> x(static_cast<std::size_t>(joint.rows), 0.0);
  std::vector<double> y(static_cast<std::size_t>(joint.cols), 0.0);
  double total = 0;
  for (int r = 0; r < joint.rows; ++r) {
    const double* row = joint.ptr<double>(r);
    for (int c = 0; c < joint.cols; ++c) {
      x[static_cast<std::size_t>(r)] += row[c];
      y[static_cast<std::size_t>(c)] += row[c];
    }
    total += x[static_cast<std::size_t>(r)];
  }
  if (!(total > 0)) return {};
  return {EntropyOf(x.data(), x.size(), total), EntropyOf(y.data(), y.size(), total),
          EntropyOf(joint.ptr<double>(), joint.total(), total)};
}

void JointHistogram::Add(double x, double y) {
  const int bins = counts_.rows;
  const int row = std::min(static_cast<int>(x * bins), bins - 1);
  const double place = y * (bins - 1);
  const int column = std::min(static_cast<int>(place), bins - 2);
  double* at = counts_.ptr<double>(row) + column;
  at[0] += column + 1 - place;
  at[1] += place - column;
  count_ += 1;
  sum_x_ += x;
  sum_y_ += y;
  sum_xx_ += x * x;
  sum_yy_ += y * y;
}

cv::Mat JointHistogram::Density() const {
  if (count_ < 1) return counts_;
  const double least = 0.01;  // of a bin: as good as none
  const double x = std::max(least, counts_.rows * Silverman(sum_x_, sum_xx_, count_));
  const double y = std::max(least, counts_.rows * Silverman(sum_y_, sum_yy_, count_));
  cv::Mat density;
  cv::GaussianBlur(counts_, density, {}, y, x, cv::BORDER_REFLECT);
  return density;
}

}  // namespace rgbdt
