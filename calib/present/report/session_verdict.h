#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calib/model/calibration.h"
#include "calib/present/report/table.h"
#include "calib/present/report/verdict.h"

namespace rgbdt {

/// What is known of one camera's calibration, in the middle of a session or at its end.
struct JudgedCamera {
  std::string camera;
  bool calibrated = false;
  int views_found = 0;  ///< views where the board was found by this camera and in the cloud
  const CameraReport* report = nullptr;  ///< null: none
};

/// Of one camera: by its report or, without one, how many views to take.
Verdict VerdictOf(const JudgedCamera& camera, const std::optional<NextView>& next_view);

/// Of all of them: the worst one's grade, which is which in the headline, and, of those that are
/// not good, why.
Verdict VerdictOfAll(const std::vector<JudgedCamera>& cameras,
                     const std::optional<NextView>& next_view);

/// How well each camera's calibration fits the held-out views.
Table HeldoutTable(const std::vector<JudgedCamera>& cameras);

}  // namespace rgbdt
