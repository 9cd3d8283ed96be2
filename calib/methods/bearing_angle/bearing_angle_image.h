#pragma once

#include <opencv2/core/mat.hpp>

#include "calib/detect/cloud/range_grid.h"

namespace rgbdt {

/// Which neighbour a bearing angle is measured to.
enum class Trace {
  kColumns,  ///< the beam before in the row
  kRows,     ///< the beam of the row before
};

/// The bearing-angle image of a cloud (section IV of Scaramuzza et al. 2007), as the grid lies:
/// CV_32FC1, rows x columns, [rad]. At each point the angle between its beam and the segment from
/// the point before: arccos((r_i - r_(i-1) cos d) / |p_i - p_(i-1)|), d being the angle between the
/// two beams. A surface faced squarely has 90 degrees, wherever it is; where the point before lies
/// far behind 180 degrees, far before 0. NaN where either beam returned nothing or is missing.
cv::Mat BearingAngles(const RangeGrid& grid, Trace trace);

}  // namespace rgbdt
