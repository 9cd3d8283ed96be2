#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calib/model/calibration.h"

namespace rgbdt {

/// From good to bad: of several cameras the worst one counts. kNone: not judged yet.
enum class Grade { kGood, kCaution, kNone, kBad };

/// "good", "caution", "none" or "bad": the word in frames, and the class in HTML.
const char* NameOf(Grade grade);

struct Verdict {
  Grade grade = Grade::kGood;
  std::string headline;
  /// Sentences; the figures are in them. What speaks against the result comes first.
  std::vector<std::string> reasons;
};

/// Of a difference of two poses (6 degrees of freedom): by chance above it once in a thousand
/// times.
inline constexpr double kUnlikelyChi2 = 22.5;

/// Of the held-out crossings' RMS in their sigmas: outside of these the sigmas are not as stated.
inline constexpr double kLeastWhitened = 0.7, kMostWhitened = 1.4;

/// How far away the points are whose reprojection uncertainty a calibration is judged by.
inline constexpr double kJudgedAtM = 5;

/// That uncertainty; null: unknown.
const ColouringSigma* JudgedColouring(const CameraReport& camera);

/// Judges by what the report itself holds, and gives the rule with the figure. Bad: not converged,
/// or views that do not determine the pose. Caution: views contradict each other, or scatter far
/// more than they state; nothing was held out; held-out views fit
/// clearly worse than the views used; few views were used; another start ended elsewhere and fits
/// about as well; the reprojection uncertainty 5 m away is more than a pixel; halves or held-out
/// views contradict the stated uncertainty. `next_view` is the report's.
Verdict Judge(const CameraReport& camera, const std::optional<NextView>& next_view = std::nullopt);

}  // namespace rgbdt
