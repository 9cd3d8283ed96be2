#pragma once

#include <Eigen/Core>
#include <array>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "calib/camera/camera.h"
#include "calib/camera/target_pose.h"
#include "calib/detect/image/saturation.h"
#include "calib/model/rig.h"

namespace rgbdt {

/// Of CornerPose::second_pose_chi2, for a board of which a part is hidden.
inline constexpr double kLeastChi2 = 15;
/// What is said of less.
inline std::string WhyLeanIsUnknown() {
  return "too little of the board can be made out to tell which way it leans";
}

/// The target's checkerboard where a person said that it is.
struct PickedBoard {
  std::vector<Eigen::Vector2d> corners;  ///< inner corners [px], the target's order; NaN: not seen
  CornerPose pose;                       ///< from those that were
};

/// The checkerboard or the reason why there is none, and what to do.
struct PickedBoardResult {
  std::optional<PickedBoard> board;
  std::string why;
};

/// Measures the checkerboard that FindCheckerboard did not find, from where a person picked the
/// corners of the board's outline: in order round the board, either way, a few pixels off. About
/// half of the inner corners may be hidden.
///   1. the picks are moved until the pattern that they predict fits the image (AlignPicks)
///   2. each inner corner is measured in the full image (FitCorner), beginning where it is
///   predicted
///   3. the pose follows from those that look like the rest and agree with a flat board, and they
///      are measured again from where the pose puts them
///   4. refused where too few are left, too close to a line for a certain pose, where the pattern
///      may as well lie a square farther on (WhyPatternMayBeShifted), and where the board's outline
///      is not where the person said
/// So the picks say where to look and no more: what comes out is as exact as what is measured, and
/// a corner that was not is NaN. `grey` is CV_32FC1, `saturated_from` as SaturatedFrom says,
/// `picks` lie in the image [px]. `black_is_dark`: see OrderCorners; `pose.half_turn_known` says
/// whether that told the half turn.
PickedBoardResult FindPickedBoard(const cv::Mat& grey, double saturated_from, const Camera& camera,
                                  const Target& target, const std::array<Eigen::Vector2d, 4>& picks,
                                  bool black_is_dark);

/// The target's inner corners [px] in another image of it, each searched near where the pose puts
/// it; NaN where none is found there. `grey` is CV_32FC1.
std::vector<Eigen::Vector2d> CornersNear(const cv::Mat& grey, double saturated_from,
                                         const Camera& camera, const Target& target,
                                         const Rigid3& camera_from_target);

}  // namespace rgbdt
