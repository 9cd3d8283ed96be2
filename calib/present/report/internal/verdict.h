#pragma once

// For calib/files and the viewer: a camera's report in plain words.

#include <optional>
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

/// Of a difference of two poses (6 degrees of freedom): by chance above it once in a thousand
/// times.
inline constexpr double kUnlikelyChi2 = 22.5;

/// Judges by what the report itself holds, and says the rule with the figure: not converged is bad,
/// and so is a pose that cannot be told from the views; caution where nothing was held out, where
/// held-out views fit clearly worse than the views used, where few views were used, where another
/// start ended elsewhere and fits about as well, where a colour 5 m away is not sure to a pixel,
/// and where halves or held-out views say that the stated sigma is not to be believed. `next_view`
/// is the report's.
Verdict Judge(const CameraReport& camera, const std::optional<NextView>& next_view = std::nullopt);

}  // namespace rgbdt
