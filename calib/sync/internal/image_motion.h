#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "calib/camera/camera.h"
#include "calib/model/rig.h"
#include "calib/sync/internal/quadratic.h"
#include "calib/sync/sync.h"

namespace rgbdt::sync {

/// An image of which a pose follows by itself.
struct PosedImage {
  Utime utime = 0;
  std::vector<Eigen::Vector2d> corners;  ///< all images' in one order; NaN: not seen, or off
  Rigid3 camera_from_target;             ///< as if all rows were exposed at once
  double sigma_px = 0;                   ///< of a corner, from the residuals
  double middle_row = 0;                 ///< of the corners, see RowShare
};

/// How far down the image a row is: -0.5 the first, 0.5 the last.
inline double RowShare(double row, int height) { return row / (height - 1) - 0.5; }

/// Images whose corners are a flat board's, by time; of those that show the same again, to a
/// hundredth of a pixel, the first alone. `repeated`: how many were left out for that. The order of
/// corners is the first image's, by half turns.
std::vector<PosedImage> PoseImages(const Camera& camera, const Target& target,
                                   const std::vector<WavedImage>& images, int* repeated);

/// All corners turned by half a turn of the target.
void TurnByHalf(PosedImage* image);

/// camera_from_target when a row was seen, `later` (share of the image's height) below the corners'
/// middle row.
using PoseByRow = std::function<Rigid3(double later)>;

/// What the corners tell of the pose at their middle row and of by_row, by how much it changes over
/// the image's height: a corner at row share s is seen where
///   Exp(delta + later by_row) * at(later), later = s - middle_row,
/// puts it. How the board moves from row to row is thus what `at` says, straight or not; what is
/// added to it is small, and straight. xi's last number stays untold.
Quadratic LineariseImage(const Camera& camera, const Target& target, const PosedImage& image,
                         double sigma_px, const PoseByRow& at);

}  // namespace rgbdt::sync
