#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calib/model/calibration.h"

namespace rgbdt::viewer {

/// A Verdict of protocol.ts.
struct VerdictWords {
  std::string grade = "none";  ///< "good", "caution", "bad" or "none"
  std::string headline;
  std::vector<std::string> reasons;
};

/// What is known of one camera's calibration.
struct JudgedCamera {
  std::string camera;
  bool calibrated = false;
  int views_found = 0;  ///< views where the board was found by this camera and in the cloud
  const CameraReport* report = nullptr;  ///< null: none
};

/// Of one camera: by its report (calib/files/verdict.h) or, without one, how many views to take.
VerdictWords VerdictOf(const JudgedCamera& camera, const std::optional<NextView>& next_view);

/// Of all of them: the worst one's grade, which is which in the headline, and, of those that are
/// not good, why.
VerdictWords VerdictOfAll(const std::vector<JudgedCamera>& cameras,
                          const std::optional<NextView>& next_view);

}  // namespace rgbdt::viewer
