#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "calib/detect/image/internal/board_map.h"
#include "calib/detect/image/internal/corner_fit.h"
#include "calib/model/rig.h"

namespace rgbdt {

inline constexpr int kLeastCorners = 8;  ///< of a board of which a part is hidden

/// What an image has where a board's inner corners should be, in the target's order.
struct MeasuredCorners {
  std::vector<std::optional<CornerFit>> fits;  ///< contrast: as of the first corner
  std::vector<double> spacings;                ///< to the next corner [px]

  double contrast() const;
  double blur_px() const;
  double sigma_px() const;
  double residual() const;
  /// RMS of what a fit leaves over, in grey values.
  double noise() const;
  std::size_t count() const;
  /// [px]; UnseenCorner where there is none.
  std::vector<Eigen::Vector2d> places() const;
};

/// Each inner corner that can be measured where `map` has it (FitCorner). Of a board with markers
/// only as much of a corner's surroundings is looked at as is free of these. `wanted`: which
/// corners; empty: all.
MeasuredCorners MeasureCorners(const cv::Mat& grey, double saturated_from, const Target& target,
                               const BoardMap& map, std::optional<double> blur_px,
                               const std::vector<bool>& wanted = {});

/// Takes out what does not look like most: light and dark exchanged, another contrast, or a larger
/// residual, as where something covers a part of what was looked at.
void DropUnlike(MeasuredCorners* measured);

/// Whether corners are enough, and far enough from one line, to tell a pose.
bool Enough(const Target& target, const std::vector<Eigen::Vector2d>& corners);
/// Likewise, and fitted well.
bool Enough(const Target& target, const MeasuredCorners& measured);

}  // namespace rgbdt
