#include "calib/detect/image/internal/square_steps.h"

#include <cmath>

#include "calib/detect/image/internal/grey_image.h"
#include "calib/model/statistics.h"

namespace rgbdt {
namespace {

double Step(const cv::Mat& grey, const GridModel& model, int column, int row, bool down) {
  const auto mean = [&](double off) {
    double sum = 0;
    for (const double along : {0.25, 0.35, 0.45, 0.55, 0.65, 0.75}) {
      const Eigen::Vector2d place =
          model.At(column + (down ? along : 1 + off), row + (down ? 1 + off : along));
      sum += Interpolate(grey, place.x(), place.y());
    }
    return sum / 6;
  };
  const double slope = mean(0.35) - mean(0.15) + mean(-0.15) - mean(-0.35);
  const double step = mean(0.15) - mean(-0.15) - 0.75 * slope;
  return (column + row) % 2 == 0 ? -step : step;
}

}  // namespace

SquareSteps::SquareSteps(const cv::Mat& grey, const GridModel& model, Range columns, Range rows,
                         int margin)
    : left_(columns.low - margin), top_(rows.low - margin) {
  const cv::Size size(columns.high - columns.low + 2 * margin, rows.high - rows.low + 2 * margin);
  for (const bool down : {false, true}) {
    cv::Mat& steps = down ? down_ : across_;
    steps = cv::Mat(size, CV_64F);
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) {
        steps.at<double>(y, x) = Step(grey, model, left_ + x, top_ + y, down);
      }
    }
  }
}

double SquareSteps::At(int column, int row, bool down) const {
  const int x = column - left_;
  const int y = row - top_;
  const bool inside = x >= 0 && y >= 0 && x < across_.cols && y < across_.rows;
  return inside ? (down ? down_ : across_).at<double>(y, x)
                : std::numeric_limits<double>::quiet_NaN();
}

std::vector<double> SquareSteps::Along(int column, int row, bool down, int squares) const {
  std::vector<double> steps;
  for (int k = 0; k + 1 < squares; ++k) {
    steps.push_back(At(column + (down ? 0 : k), row + (down ? k : 0), down));
  }
  return steps;
}

std::vector<double> SquareSteps::Across(int column, int row, bool down, int squares) const {
  std::vector<double> steps;
  for (int k = 0; k < squares; ++k) {
    steps.push_back(At(column + (down ? k : 0), row + (down ? 0 : k), down));
  }
  return steps;
}

std::vector<double> SeenSteps(const std::vector<double>& steps, double typical) {
  std::vector<double> seen;
  for (const double step : steps) {
    if (std::isfinite(step)) seen.push_back(step / typical);
  }
  return seen;
}

double ShareBetween(const std::vector<double>& values, double low, double high) {
  const auto inside =
      std::count_if(values.begin(), values.end(), [&](double v) { return v >= low && v <= high; });
  return static_cast<double>(inside) / static_cast<double>(values.size());
}

bool Alternates(const std::vector<double>& steps) {
  return Median(steps) > 0.3 && ShareBetween(steps, 0.15, 5) > 0.6;
}

bool GoesOn(const std::vector<double>& along, const std::vector<double>& across) {
  return Median(along) > 0.4 && ShareBetween(along, 0.3, 3) > 0.7 &&
         ShareBetween(across, 0.3, 3) > 0.7;
}

}  // namespace rgbdt
