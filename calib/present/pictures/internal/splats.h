#pragma once

// From points to pixels.

#include <limits>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace rgbdt {

inline constexpr float kNoDepth = std::numeric_limits<float>::infinity();

/// A point as it lies in the picture.
struct Splat {
  cv::Point2d centre;  // [px]
  double radius = 0;   // [px]
  float depth = 0;     // [m]
  cv::Vec3b bgr;
};

/// The picture while it is drawn.
struct Canvas {
  cv::Mat bgr;    // CV_8UC3
  cv::Mat depth;  // CV_32FC1; infinite: background
};

/// Draws the discs, the nearest in front. Two passes (surface splatting, Zwicker 2001, with round
/// splats): first how near the front is; then the mean of all discs that belong to the front, so
/// that range noise does not show as specks.
void DrawSplats(const std::vector<Splat>& splats, Canvas* canvas);

/// Closes the holes of a surface, through which what lies behind it would show: a pixel between
/// nearer ones that belong together, on opposite sides within a few pixels, takes their mean.
void CloseHoles(Canvas* canvas);

/// Eye-dome lighting (Boucheny 2009): a pixel is the darker the further its surroundings stand in
/// front of it.
void Shade(Canvas* canvas);

}  // namespace rgbdt
