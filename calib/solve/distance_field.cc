#include "calib/solve/distance_field.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>

#include "calib/model/errors.h"

namespace rgbdt {
namespace {

constexpr int kFrom = -5;
constexpr int kTo = 4;
constexpr int kSide = kTo - kFrom + 1;
constexpr int kWindow = kSide * kSide;

using FitMatrix = Eigen::Matrix<double, 6, kWindow>;

// Least squares over a window whose offsets never change: one matrix for all pixels.
const FitMatrix& Fitter() {
  static const FitMatrix matrix = [] {
    Eigen::Matrix<double, kWindow, 6> design;
    for (int i = 0; i < kWindow; ++i) {
      const int row = i / kSide;
      const double x = i % kSide + kFrom;
      const double y = row + kFrom;
      design.row(i) << 1, x, y, x * x, x * y, y * y;
    }
    return FitMatrix(
        (design.transpose() * design).ldlt().solve(Eigen::MatrixXd(design.transpose())));
  }();
  return matrix;
}

cv::Mat Transform(int width, int height, const std::vector<Eigen::Vector2i>& edge_pixels) {
  cv::Mat background(height, width, CV_8U, cv::Scalar(255));
  bool any = false;
  for (const Eigen::Vector2i& p : edge_pixels) {
    if (p.x() < 0 || p.y() < 0 || p.x() >= width || p.y() >= height) continue;
    background.at<std::uint8_t>(p.y(), p.x()) = 0;
    any = true;
  }
  if (!any) {
    throw InputError("distance field: none of " + std::to_string(edge_pixels.size()) +
                     " edge pixels lies in the image of " + std::to_string(width) + "x" +
                     std::to_string(height));
  }
  cv::Mat transform;
  cv::distanceTransform(background, transform, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  return transform;
}

int Round(double value, int size) {
  return static_cast<int>(std::clamp(std::floor(value + 0.5), 0.0, size - 1.0));
}

}  // namespace

DistanceField::DistanceField(int width, int height, const std::vector<Eigen::Vector2i>& edge_pixels,
                             FieldBeyond beyond)
    : beyond_(beyond), transform_(Transform(width, height, edge_pixels)) {}

DistanceField::Surface DistanceField::Fit(int x, int y) const {
  Eigen::Matrix<double, kWindow, 1> values;
  for (int i = 0; i < kWindow; ++i) {
    const int column = std::clamp(x + i % kSide + kFrom, 0, transform_.cols - 1);
    const int row = std::clamp(y + i / kSide + kFrom, 0, transform_.rows - 1);
    values[i] = transform_.at<float>(row, column);
  }
  return Fitter() * values;
}

const DistanceField::Surface& DistanceField::SurfaceAt(int x, int y) const {
  // Who only asks for the transform itself needs no table.
  if (lookup_.empty()) lookup_.assign(transform_.total(), -1);
  std::int32_t& entry =
      lookup_[static_cast<std::size_t>(y) * static_cast<std::size_t>(transform_.cols) +
              static_cast<std::size_t>(x)];
  if (entry < 0) {
    entry = static_cast<std::int32_t>(surfaces_.size());
    surfaces_.push_back(Fit(x, y));
  }
  return surfaces_[static_cast<std::size_t>(entry)];
}

double DistanceField::Value(const Eigen::Vector2d& pixel) const {
  const Eigen::Vector2d border(std::clamp(pixel.x(), 0.0, transform_.cols - 1.0),
                               std::clamp(pixel.y(), 0.0, transform_.rows - 1.0));
  if (border == pixel) return Inside(pixel);
  return beyond_ == FieldBeyond::kSmooth ? Smooth(border, pixel - border) : Nearest(pixel);
}

DistanceField::Place DistanceField::PlaceOf(const Eigen::Vector2d& point) const {
  const int column = Round(point.x(), transform_.cols);
  const int row = Round(point.y(), transform_.rows);
  return {SurfaceAt(column, row), {point.x() - column, point.y() - row}};
}

double DistanceField::Inside(const Eigen::Vector2d& pixel) const {
  const auto& [s, offset] = PlaceOf(pixel);
  const double x = offset.x();
  const double y = offset.y();
  return s[0] + s[1] * x + s[2] * y + s[3] * x * x + s[4] * x * y + s[5] * y * y;
}

Eigen::Vector2d DistanceField::Slope(const Eigen::Vector2d& pixel) const {
  const auto& [s, offset] = PlaceOf(pixel);
  const double x = offset.x();
  const double y = offset.y();
  return {s[1] + 2 * s[3] * x + s[4] * y, s[2] + s[4] * x + 2 * s[5] * y};
}

// The border's value and, fading, its slope; what is added has no slope at the border and one of 1
// far away.
double DistanceField::Smooth(const Eigen::Vector2d& border, const Eigen::Vector2d& off) const {
  constexpr double kReachPx = 10;  // within which the one slope becomes the other
  const double distance = off.norm();
  return Inside(border) + Slope(border).dot(off) * std::exp(-distance / kReachPx) +
         std::hypot(distance, kReachPx) - kReachPx;
}

double DistanceField::Nearest(const Eigen::Vector2d& pixel) const {
  return transform_.at<float>(Round(pixel.y(), transform_.rows), Round(pixel.x(), transform_.cols));
}

}  // namespace rgbdt
