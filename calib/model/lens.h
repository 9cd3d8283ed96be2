#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "calib/model/rigid3.h"

namespace rgbdt {

/// Lens parameters, OpenCV's order and meaning. Pixel centres at integer coordinates.
struct Lens {
  enum class Model {
    kPinhole,  ///< distortion k1 k2 p1 p2 k3 [k4 k5 k6]; unused ones 0
    kFisheye,  ///< equidistant, distortion k1 k2 k3 k4
  };
  Model model = Model::kPinhole;
  double fx = 0, fy = 0, cx = 0, cy = 0;  ///< [px]
  std::array<double, 8> distortion{};

  /// False: nobody has found it yet; the numbers say nothing, the model is what is wanted.
  bool known() const { return fx != 0 || fy != 0; }
};
bool operator==(const Lens& a, const Lens& b);
inline bool operator!=(const Lens& a, const Lens& b) { return !(a == b); }

/// A lens's numbers that a calibration may correct: fx fy cx cy [px], then the distortion's first
/// five (k1 k2 p1 p2 k3) or, of the fisheye, four (k1 k2 k3 k4) and an unused one. The rational
/// model's k4 k5 k6 are taken as they are.
inline constexpr int kLensNumbers = 9;
using LensNumbers = Eigen::Matrix<double, kLensNumbers, 1>;
using LensCovariance = Eigen::Matrix<double, kLensNumbers, kLensNumbers>;

LensNumbers NumbersOf(const Lens& lens);
Lens WithNumbers(Lens lens, const LensNumbers& numbers);
/// "fx", ..., "k3"; how many of them the model has is the list's length.
std::vector<std::string> NamesOfNumbers(Lens::Model model);

/// How well a lens is known.
struct LensUncertainty {
  LensCovariance covariance = LensCovariance::Zero();  ///< of its numbers; zero: exactly
  /// Of each image that the lens was made from, the mean of the target's inner corners [px], by
  /// which it is known again; empty where nothing is known of them.
  std::vector<Eigen::Vector2d> made_from;

  bool exact() const { return covariance.isZero(0); }
};

/// The mean of the corners that were seen; NaN where none was.
Eigen::Vector2d MiddleOf(const std::vector<Eigen::Vector2d>& corners);

/// Of a lens of which nothing is said: published ones differ from what their own camera's images
/// say by half a percent in the focal length, by 0.6% of the image's width in the centre, and in
/// the distortion by what moves a pixel half a percent of its distance from the middle. Single
/// coefficients differ by far more than that, and make up for each other.
LensUncertainty UsualLensUncertainty(const Lens& lens, int width, int height);

/// A camera's pose and its lens together: delta (rigid3.h), then the lens's numbers.
inline constexpr int kPoseAndLens = 6 + kLensNumbers;
using PoseAndLensCovariance = Eigen::Matrix<double, kPoseAndLens, kPoseAndLens>;

/// Of a pose whose lens is exact.
PoseAndLensCovariance WithExactLens(const Matrix6d& covariance);

}  // namespace rgbdt
