#include "calib/fuse/range_correction.h"

namespace rgbdt {

RangeCorrection RangeCorrectionFor(const std::vector<std::optional<RangeErrors>>& of_cameras) {
  RangeCorrection correction;
  for (const std::optional<RangeErrors>& errors : of_cameras) {
    if (!correction.errors) correction.errors = errors;
    if (!(errors == of_cameras.front())) correction.cameras_differ = true;
  }
  return correction;
}

}  // namespace rgbdt
