#include "calib/detect/image/internal/grid_model.h"

#include <Eigen/Geometry>
#include <opencv2/calib3d.hpp>
#include <vector>

#include "calib/model/linear_algebra.h"

namespace rgbdt {
namespace {

using Terms = Eigen::Matrix<double, 10, 1>;

Terms TermsOf(double u, double v) {
  Terms t;
  t << 1, u, v, u * u, u * v, v * v, u * u * u, u * u * v, u * v * v, v * v * v;
  return t;
}

}  // namespace

Eigen::Vector2d GridModel::At(double column, double row) const {
  const Eigen::Vector2d uv = (Eigen::Vector2d(column, row) - centre_) / scale_;
  const Eigen::Vector2d flat = (homography_ * uv.homogeneous()).hnormalized();
  return flat + bend_.transpose() * TermsOf(uv.x(), uv.y());
}

Eigen::Matrix2d GridModel::Steps(double column, double row) const {
  Eigen::Matrix2d steps;
  steps << At(column + 0.5, row) - At(column - 0.5, row),
      At(column, row + 0.5) - At(column, row - 0.5);
  return steps;
}

Eigen::Matrix2d GridModel::Bends(double column, double row) const {
  const Eigen::Vector2d here = At(column, row);
  Eigen::Matrix2d bends;
  bends << At(column + 1, row) - 2 * here + At(column - 1, row),
      At(column, row + 1) - 2 * here + At(column, row - 1);
  return bends;
}

double GridModel::Spacing(double column, double row) const {
  return Steps(column, row).colwise().norm().minCoeff();
}

bool GridModel::Agrees(const CornerGrid::value_type& corner, double tolerance) const {
  const auto [column, row] = corner.first;
  return Agrees({Eigen::Vector2d(column, row), corner.second}, tolerance);
}

bool GridModel::Agrees(const Point& point, double tolerance) const {
  const double column = point.at.x();
  const double row = point.at.y();
  return (At(column, row) - point.place).norm() < tolerance * Spacing(column, row);
}

std::optional<GridModel> GridModel::Fit(const CornerGrid& grid, double tolerance) {
  std::vector<Point> points;
  for (const auto& [at, place] : grid) points.push_back({{at.first, at.second}, place});
  return Fit(points, tolerance);
}

std::optional<GridModel> GridModel::Fit(const std::vector<Point>& points, double tolerance) {
  if (points.size() < 8) return std::nullopt;
  GridModel model;
  for (const Point& point : points) model.centre_ += point.at;
  model.centre_ /= static_cast<double>(points.size());
  for (const Point& point : points) {
    model.scale_ = std::max(model.scale_, (point.at - model.centre_).cwiseAbs().maxCoeff());
  }
  std::vector<Point> agreeing = points;
  for (int round = 0; round < 4; ++round) {
    std::vector<cv::Point2d> from;
    std::vector<cv::Point2d> to;
    for (const auto& [at, place] : agreeing) {
      from.emplace_back((at.x() - model.centre_.x()) / model.scale_,
                        (at.y() - model.centre_.y()) / model.scale_);
      to.emplace_back(place.x(), place.y());
    }
    const cv::Mat h = cv::findHomography(from, to);
    if (h.empty()) return std::nullopt;
    for (int i = 0; i < 9; ++i) model.homography_(i / 3, i % 3) = h.at<double>(i / 3, i % 3);
    model.bend_.setZero();
    // A weak pull towards zero keeps terms that few corners decide on from running off.
    Eigen::Matrix<double, 10, 10> normal = 1e-2 * Eigen::Matrix<double, 10, 10>::Identity();
    Eigen::Matrix<double, 10, 2> right = Eigen::Matrix<double, 10, 2>::Zero();
    for (std::size_t i = 0; i < from.size(); ++i) {
      const Terms t = TermsOf(from[i].x, from[i].y);
      const Eigen::Vector2d uv(from[i].x, from[i].y);
      const Eigen::Vector2d flat = (model.homography_ * uv.homogeneous()).hnormalized();
      normal += t * t.transpose();
      right += t * (Eigen::Vector2d(to[i].x, to[i].y) - flat).transpose();
    }
    model.bend_ = SolveSymmetric(normal, right);
    // Outliers leave step by step: the first fit is drawn towards them.
    const double allowed = round == 0 ? 3 * tolerance : round == 1 ? 1.5 * tolerance : tolerance;
    std::vector<Point> next;
    for (const Point& point : points) {
      if (model.Agrees(point, allowed)) next.push_back(point);
    }
    if (next.size() < 8 || 2 * next.size() < points.size()) return std::nullopt;
    agreeing = std::move(next);
  }
  return model;
}

}  // namespace rgbdt
