#pragma once

#include <Eigen/Core>

namespace rgbdt::sync {

/// What an image or a sweep tells of a pose, how it moves, and what ranges are off by, all in one:
/// xi = (delta of the pose [rad, m]; the change of that with the row, or with time; [m]), about
/// what is predicted. Residuals are linear in it, their squares sum up to
///   |root (xi - predicted) + rest|^2 + misfit.
struct Quadratic {
  static constexpr int kSize = 13;
  using Vector = Eigen::Matrix<double, kSize, 1>;
  using Matrix = Eigen::Matrix<double, kSize, kSize>;

  Matrix root = Matrix::Zero();
  Vector rest = Vector::Zero();
  double misfit = 0;  ///< what no xi takes away
  int rows = 0;       ///< how many residuals
  int rank = 0;       ///< how many numbers of xi they tell
};

/// Residuals' normal equations, put together one by one.
class QuadraticSum {
 public:
  /// `slope`: of the residual by xi.
  void Add(const Quadratic::Vector& slope, double residual, double weight = 1) {
    information_.noalias() += weight * slope * slope.transpose();
    gradient_ += weight * residual * slope;
    square_ += weight * residual * residual;
    ++rows_;
  }
  Quadratic Root() const;

 private:
  Quadratic::Matrix information_ = Quadratic::Matrix::Zero();
  Quadratic::Vector gradient_ = Quadratic::Vector::Zero();
  double square_ = 0;
  int rows_ = 0;
};

}  // namespace rgbdt::sync
