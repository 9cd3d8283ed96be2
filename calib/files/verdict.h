#pragma once

// Inside calib/files only: a camera's report in plain words.

#include <string>
#include <vector>

#include "calib/model/calibration.h"

namespace rgbdt {

struct Verdict {
  enum class Grade { kGood, kCaution, kBad };
  Grade grade = Grade::kGood;
  std::string headline;
  std::vector<std::string> reasons;  ///< sentences; the figures are in them
};

/// Judges by what the report itself holds, and says the rule with the figure: not converged is bad;
/// caution where nothing was held out, where held-out views fit clearly worse than the views used,
/// where few views were used, or where another start ended elsewhere and fits about as well.
Verdict Judge(const CameraReport& camera);

}  // namespace rgbdt
