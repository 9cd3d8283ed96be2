#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "calib/detect/image/saturation.h"
#include "calib/model/rig.h"

namespace rgbdt {

/// The target's checkerboard in an image.
struct Checkerboard {
  /// Inner corners [px], sub-pixel, row by row in the target's order up to a half turn (a quarter
  /// turn where the pattern is square). Never mirrored: rows run to the right of columns, y down.
  /// NaN (UnseenCorner) where one lies outside the image or too close to its edge to be measured.
  std::vector<Eigen::Vector2d> corners;
  /// Whether the square above and left of the first corner is darker than its neighbours. Colour
  /// images show black dark; a thermal image shows it light where black is the warmer one.
  bool top_left_dark = false;
  /// Whether they are in the target's own order for certain, since its markers say so.
  bool order_known = false;
  /// Typical uncertainty of a corner along its worst direction [px], from the image's noise.
  double sigma_px = 0;
};

/// The checkerboard or the reason why there is none.
struct CheckerboardResult {
  std::optional<Checkerboard> board;
  std::string why;
};

/// Finds the checkerboard in grey values (CV_32FC1, finite, any unit) of any camera, of either
/// polarity and unevenly bright; of at least 3x3 inner corners. All of its squares must be seen, or
/// at least three quarters of its corners where the rest is outside the image; hands may hold it by
/// the border. (A part of it hidden: FindPickedBoard.)
///   1. dead pixels are repaired
///   2. saddles of the brightness are found (FindSaddles), at one size after another; where that
///      leads to no board and white is saturated, again with white made narrower
///   3. grids are grown among them (GridFinder)
///   4. the pattern's place in the grid follows from which squares alternate (MatchPattern)
///   5. each corner is measured in the full image (FitCorner)
/// Corners that do not follow a flat grid seen through a smooth lens, or whose light and dark are
/// exchanged, are refused: up to 5% of them are then taken from the others' grid, with more there
/// is no board. Nor is there where corners scatter about their grid by more than 1% of the distance
/// of neighbours and the image's noise: meshes and tiles do. A board that is partly outside the
/// image is looked for where no sure one is found, and only what is certain is taken
/// (WhyNotPartial): along rows and along columns one of its ends is seen with what lies beyond, the
/// other follows from the size. A target of another size whose other end is outside the image as
/// well cannot be told from it. Of several boards the one that fits best is returned.
/// `saturated_from`: see SaturatedFrom; corners of white that is overexposed are not rounded off
/// then. A target with markers is found by these (FindMarkedBoard).
CheckerboardResult FindCheckerboard(const cv::Mat& grey, const Target& target,
                                    double saturated_from = kNeverSaturated);

}  // namespace rgbdt
