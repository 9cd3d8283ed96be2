#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "calib/detect/image/internal/grid_model.h"
#include "calib/detect/image/internal/square_steps.h"
#include "calib/model/rig.h"

namespace rgbdt {

/// Where the target's pattern lies in a grid.
struct PatternMatch {
  int column = 0, row = 0;  ///< of the inner corner with the least of both
  bool turned = false;      ///< the pattern's columns are the grid's rows

  int columns(const Target& t) const { return turned ? t.corners_y() : t.corners_x(); }
  int rows(const Target& t) const { return turned ? t.corners_x() : t.corners_y(); }
};

/// Every place of the pattern, turned or not, that goes beyond these columns and rows of corners by
/// no more than `reach`.
std::vector<PatternMatch> PlacesIn(const Range& columns, const Range& rows, int reach,
                                   const Target& target);

/// Where in a grid the pattern may lie, judging by the squares between its corners; most likely
/// first. `grey` is CV_32FC1; `model` maps the grid to its pixels.
std::vector<PatternMatch> PatternCandidates(const cv::Mat& grey, const GridModel& model,
                                            const CornerGrid& grid, const Target& target);

/// The corners of the pattern that a grid holds.
CornerGrid CornersIn(const PatternMatch& match, const CornerGrid& grid, const Target& target);

enum class PatternFit { kNo, kYes, kGoesOn };

/// Whether the pattern with its outermost squares is there and ends there: each of their rows and
/// columns must alternate between light and dark all along, and the next beyond must not. A grid
/// alone does not tell: where the pattern meets its border there are corners, too. Brightness is
/// compared across the edge between two squares only, which sees neither a glow nor what lies
/// beside the board. `model` must be fitted to the pattern's own corners: it is extended by a
/// square.
PatternFit MatchPattern(const cv::Mat& grey, const GridModel& model, const PatternMatch& match,
                        const Target& target);

}  // namespace rgbdt
