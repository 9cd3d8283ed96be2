#pragma once

#include <Eigen/Core>
#include <limits>
#include <opencv2/core/mat.hpp>
#include <optional>

#include "calib/detect/image/saturation.h"

namespace rgbdt {

/// A checkerboard's corner, measured.
struct CornerFit {
  Eigen::Vector2d place{0, 0};  ///< [px]
  /// Half of light minus dark; positive where the patch between the two steps, and the one opposite
  /// it, are the lighter ones. Where the light ones are saturated: as far as the image shows it.
  double contrast = 0;
  bool saturated = false;  ///< whether any of its pixels was
  double blur_px = 0;      ///< sigma of the edges
  double residual = 0;     ///< RMS of what the fit leaves over, of the contrast
  double sigma_px = 0;  ///< of the place along its worst direction, from what the fit leaves over
};

inline constexpr double kCornerReach = 0.75;  ///< of a step, that FitCorner looks far

/// How far from a corner FitCorner looks along x and y [px].
Eigen::Vector2d CornerReach(const Eigen::Matrix2d& steps);

/// Where the one patch lies that differs from the three others, at the corner of a square that
/// stands alone: 1 or -1 along each of the two steps; 0, 0: two patches of each colour meet.
using LonePatch = Eigen::Vector2d;

/// Fits to the pixels round a corner
///   b(x, y) + contrast * erf(e1 / (sqrt(2) s)) * erf(e2 / (sqrt(2) s))
/// with b a polynomial of second degree (glow), e1 and e2 the distances to two edges and s the
/// blur, by least squares. The edges bend as the lens makes the grid's lines bend (`bends`): taken
/// for straight ones, they draw every corner towards the image's middle, by 1e-5 to 1e-4 of its
/// distance from there. With `blur_px` given, blur and the edges' directions (along `steps`) are
/// taken as known, which helps weak corners, and b is of third degree where that clearly fits
/// better (not where a patch is saturated: what it does there is not seen). Values of
/// `saturated_from` and above only say that the corner is at least that bright (LowerBound), since
/// what a sensor clips is the blurred corner: taken for values, they round the corner off. `grey`
/// is CV_32FC1, dead pixels repaired. `steps`: image shift from this corner to the next column
/// (first) and to the next row [px]; `bends`: second differences of the grid's places, likewise
/// (GridModel::Bends). `clear`: pixels farther than that from both edges [steps] are not looked at,
/// since something else is there. With a `lone` patch that holds in this patch alone, and the
/// product above is
///   (1 + lone.x erf(e1 / ...)) (1 + lone.y erf(e2 / ...)) / 2
/// and contrast is negative where that patch is the darker one. Nothing where the fit leaves the
/// neighbourhood of `place`, the pixels are not all seen or do not look like that.
std::optional<CornerFit> FitCorner(const cv::Mat& grey, const Eigen::Vector2d& place,
                                   const Eigen::Matrix2d& steps, const Eigen::Matrix2d& bends,
                                   std::optional<double> blur_px = std::nullopt,
                                   double saturated_from = kNeverSaturated,
                                   double clear = std::numeric_limits<double>::infinity(),
                                   const LonePatch& lone = {0, 0});

}  // namespace rgbdt
