#pragma once

// Inside calib/camera only: the lens and the views' poses that explain the corners best.

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "calib/model/intrinsics.h"

namespace rgbdt {

/// fx fy cx cy k1 ...: what is solved for.
std::vector<std::string> ParameterNames(LensChoice choice);
std::vector<double> ParametersOf(const Lens& lens, LensChoice choice);
Lens LensOf(const std::vector<double>& parameters, LensChoice choice);

struct BundleView {
  std::vector<Eigen::Vector2d> pixels;  ///< one for each of Bundle::points
  std::vector<bool> used;
  bool posed = false;   ///< has a pose
  bool active = false;  ///< has one, and takes part
  Vector6d pose;        ///< camera_from_target: rotation vector [rad], translation [m]
};

/// How the board differs from its drawing, which all views share: the pattern's height over its
/// width, over what its squares make it, less one; then bow_x, twist and bow_y [m]
/// (Target::BowFactors). The pattern's size as a whole is the views' distances', and none of the
/// lens's.
enum BoardUnknown { kAspect, kBow, kBoardUnknowns = kBow + 3 };
using BoardNumbers = std::array<double, kBoardUnknowns>;

struct Bundle {
  LensChoice choice = LensChoice::kPinhole5;
  std::vector<double> lens;                    ///< ParametersOf
  double least_focal = 0, greatest_focal = 0;  ///< bounds of fx and fy [px]
  std::vector<Eigen::Vector3d> points;         ///< the target's corners, target frame [m]
  std::vector<Eigen::Vector3d> bow_factors;    ///< of each of them
  BoardNumbers board{};
  std::optional<BoardNumbers> board_sigmas;  ///< known beforehand, about zero; absent: it is zero
  std::vector<BundleView> views;
};

struct BundleSolve {
  int parameters = 0;     ///< the first so many of the lens are free; the rest is held
  double loss_scale = 0;  ///< of Cauchy's loss [px]; 0: least squares
  int max_iterations = 150;
};

/// Levenberg-Marquardt with exact derivatives over the lens, the board and every active view's
/// pose. False where it stopped before its end; `why` then says so.
bool Solve(const BundleSolve& options, Bundle* bundle, std::string* why);

/// The same for one view's pose alone, active or not, from all of its corners with Cauchy's loss.
void SolvePose(double loss_scale, const Bundle& bundle, BundleView* view);

/// Measured - predicted [px] of each corner of a view, active or not.
std::vector<Eigen::Vector2d> Residuals(const Bundle& bundle, const BundleView& view);

/// Covariance of the lens' parameters and, where they are not known, the board's numbers; the poses
/// eliminated, scaled with the residuals' variance. Empty where the corners do not determine every
/// parameter.
Eigen::MatrixXd CovarianceOfLensAndBoard(const Bundle& bundle);

}  // namespace rgbdt
