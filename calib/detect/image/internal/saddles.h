#pragma once

#include <Eigen/Core>
#include <array>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace rgbdt {

/// A place where four patches meet like those of a checkerboard: the image's second derivative is
/// positive one way and negative the other.
struct Saddle {
  Eigen::Vector2d place{0, 0};    ///< [px]
  Eigen::Vector3d hessian;        ///< xx, sqrt(2) xy, yy of the blurred image, of unit length
  double strength = 0;            ///< sqrt(-determinant), grey values per px^2
  std::array<double, 2> edges{};  ///< angles of the two edges that cross here, 0 to pi [rad]
};

/// How alike two saddles are: 1 the same, -1 with light and dark exchanged.
inline double Likeness(const Saddle& a, const Saddle& b) { return a.hessian.dot(b.hessian); }

/// All saddles of a CV_32FC1 image after a blur of `sigma` [px], in reading order. The second
/// derivative does not see a brightness that changes evenly, and the threshold follows the image's
/// own noise, so weak patterns under a strong glow are found like strong ones.
std::vector<Saddle> FindSaddles(const cv::Mat& grey, double sigma);

}  // namespace rgbdt
