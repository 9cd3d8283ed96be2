#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "calib/model/rig.h"

namespace rgbdt {

// Corners may be NaN where they were not seen; what is said follows from the others.

/// Whether the corners begin beside a dark square: the one between the first corner and the
/// pattern's outer corner next to it. From the brightness of all squares between the corners
/// against their neighbours, so uneven light does not matter. Nothing where fewer than four fifths
/// of them alternate. `grey` is CV_32FC1.
std::optional<bool> TopLeftIsDark(const cv::Mat& grey, const Target& target,
                                  const std::vector<Eigen::Vector2d>& corners);

/// Puts corners that are in the target's order up to a half turn or a mirroring into the target's
/// own order: right-handed and, where the pattern tells top from bottom and `black_is_dark` (of a
/// thermal image that is not known), beginning at the target's top left. Returns whether the half
/// turn is known.
bool OrderCorners(const cv::Mat& grey, const Target& target, bool black_is_dark,
                  std::vector<Eigen::Vector2d>* corners);

}  // namespace rgbdt
