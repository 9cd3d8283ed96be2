#pragma once

#include <array>
#include <opencv2/core/mat.hpp>

#include "calib/camera/camera.h"
#include "calib/model/rig.h"
#include "calib/model/view_detection.h"

namespace rgbdt {

/// What the search for the board's sides takes for granted.
struct BoardSidesOptions {
  double size_tolerance_m = 0.002;  ///< a side may be this far from where the pattern puts it
  /// Boards are no thicker. Seen from aside, a board's edge shows its thickness: where it could by
  /// more than `max_thickness_px`, the outline's place is not known from the image, and the side
  /// counts as not seen.
  double thickness_m = 0.02;
  double max_thickness_px = 0.3;
  double min_share = 0.3;      ///< of a side's length along which its edge must be seen, 0 to 1
  double max_sigma_px = 0.35;  ///< a side whose ends are less certain is not seen
  /// Where a side cannot be seen else, edges beside saturated pixels count, too: all along it they
  /// are off their place by this (1 sigma). 0: they never count.
  double saturated_px = 0;

  /// Throws InputError naming the field and its value.
  void Check() const;
};

/// The board's four sides (top, right, bottom, left) in an image: each predicted from the pose and
/// the board's size, then displaced and turned onto the image's own gradient across it, of either
/// polarity, through the lens. `grey` is CV_32FC1 and `clipped` what Clipped() says of
/// the image; `camera_from_target` with its covariance.
std::array<ImageSide, 4> FitBoardSides(const cv::Mat& grey, const cv::Mat& clipped,
                                       const Camera& camera, const Target& target,
                                       const TargetPose& camera_from_target,
                                       const BoardSidesOptions& options = {});

}  // namespace rgbdt
