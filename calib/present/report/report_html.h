#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "calib/model/calibration.h"

namespace rgbdt {

struct ReportPicture {
  std::string title;
  std::string caption;
  cv::Mat bgr;  ///< 8-bit
};

/// One page that needs nothing else (no script, no network): for each camera a verdict in plain
/// words, figures with units, the transform both ways, every view and every other start. Safe
/// whatever the names in the report are. The same input gives the same bytes.
std::string ReportHtml(const Report& report, const std::vector<ReportPicture>& pictures);

}  // namespace rgbdt
