#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "calib/present/report/report_content.h"

namespace rgbdt {

struct ReportPicture {
  std::string title;
  std::string caption;
  cv::Mat bgr;  ///< 8-bit
};

/// The report as one page that needs nothing else (no script, no network), for builds without the
/// viewer's page. Safe whatever the names in the report are. The same input gives the same bytes.
std::string ReportHtml(const ReportContent& content, const std::vector<ReportPicture>& pictures);

}  // namespace rgbdt
