#pragma once

#include <opencv2/core/mat.hpp>

#include "calib/detect/image/checkerboard.h"
#include "calib/model/rig.h"

namespace rgbdt {

/// Finds a board with markers (ChArUco, AprilTag grid) in grey values, as FindCheckerboard does one
/// without; a part of it is enough, whatever hides the rest. Corners are in the target's own order.
///   1. markers are decoded (DecodeMarkers); those that are not where the others say are dropped
///   2. a smooth map from the board to the image is fitted to their corners (GridModel)
///   3. each inner corner beside a marker that was decoded is measured (MeasureCorners); the map is
///      fitted to these, and they are measured again
/// What does not look like the rest, or lies off the map, is left out (NaN). Refused, in words:
/// markers of another family or mirrored, numbers that the board has not, or markers that lie as on
/// a board with other rows or columns. Of a board with holes the corners are its markers'. Why
/// there are no markers takes long to find out: without `tell_why` it is not asked.
CheckerboardResult FindMarkedBoard(const cv::Mat& grey, const Target& target, double saturated_from,
                                   bool tell_why = true);

}  // namespace rgbdt
