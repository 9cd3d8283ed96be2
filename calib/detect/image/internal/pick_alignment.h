#pragma once

#include <Eigen/Core>
#include <array>
#include <opencv2/core/mat.hpp>
#include <optional>

#include "calib/camera/camera.h"
#include "calib/model/rig.h"

namespace rgbdt {

/// A person's picks, moved onto the image's own pattern.
struct AlignedPicks {
  std::array<Eigen::Vector2d, 4> picks;    ///< as they were, but in the order of `outline` [px]
  std::array<Eigen::Vector2d, 4> outline;  ///< moved; the target's order, perhaps half a turn off
  double likeness = 0;  ///< of the pattern to the image, mean over the inner corners, 0 to 1
};

/// Moves picked outline corners [px] until the pattern that they predict is most like the image:
/// the sum over inner corners of the correlation with four squares that meet, light and dark
/// unknown, less what it costs to move. The picks may begin anywhere and go either way round.
/// The result is where FitCorner may begin, good to a fraction of the distance between corners.
/// Nothing where the picks are no board's outline. `grey` is CV_32FC1.
std::optional<AlignedPicks> AlignPicks(const cv::Mat& grey, const Camera& camera,
                                       const Target& target,
                                       const std::array<Eigen::Vector2d, 4>& picks);

}  // namespace rgbdt
