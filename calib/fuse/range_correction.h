#pragma once

#include <optional>
#include <vector>

#include "calib/model/range_errors.h"

namespace rgbdt {

/// The range errors that a cloud is corrected by before several cameras colour it.
struct RangeCorrection {
  std::optional<RangeErrors> errors;  ///< the first camera's that has any; absent: none has
  bool cameras_differ = false;        ///< in their range errors: they were not solved together
};

/// `of_cameras`: of each calibrated camera, as its calibration has them. All cameras of one joint
/// solve have the same.
RangeCorrection RangeCorrectionFor(const std::vector<std::optional<RangeErrors>>& of_cameras);

}  // namespace rgbdt
