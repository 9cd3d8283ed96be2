#pragma once

#include <string>
#include <vector>

#include "calib/model/comparison.h"
#include "calib/model/time.h"

namespace rgbdt {

/// Two calibrations of a rig: b against a, whichever is the later one.
struct CalibrationComparison {
  std::string a, b;                ///< as the user named them
  Utime utime_a = 0, utime_b = 0;  ///< 0: not known
  bool same_rig = true;            ///< the rig files are the same, lenses and all
  std::vector<PoseComparison> cameras;
};

/// Whether a comparison says that a camera moved: beyond what chance does once in a hundred.
bool Moved(const PoseComparison& camera);

/// In words and figures, for a terminal.
std::string ComparisonText(const CalibrationComparison& comparison);

}  // namespace rgbdt
