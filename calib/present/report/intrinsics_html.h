#pragma once

#include <string>
#include <vector>

#include "calib/model/intrinsics.h"

namespace rgbdt {

/// What the page shows of one camera.
struct CameraIntrinsics {
  std::string camera;
  int width = 0, height = 0;          ///< [px]
  std::vector<IntrinsicsView> views;  ///< what was solved from
  IntrinsicsResult result;
};

/// One page that needs nothing else (no script, no network): for each camera whether it can be
/// trusted, every parameter with its sigma, a drawing of all corners with their residuals, every
/// view. The same input gives the same bytes.
std::string IntrinsicsHtml(const std::vector<CameraIntrinsics>& cameras);

}  // namespace rgbdt
