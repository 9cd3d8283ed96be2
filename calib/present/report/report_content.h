#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calib/model/calibration.h"
#include "calib/model/rigid3.h"
#include "calib/present/report/table.h"
#include "calib/present/report/verdict.h"

namespace rgbdt {

/// A transform, with the sentences that say which way it goes.
struct NamedPose {
  std::string name;  ///< "camera_from_lidar"
  std::string sentence;
  Rigid3 pose;
};

struct CameraContent {
  std::string camera;
  Verdict verdict;
  std::vector<NamedPose> poses;
  std::vector<Table> tables;  ///< none is empty
};

struct NextViewWords {
  std::string words;
  std::string gain;  ///< where that is in the LIDAR's frame, and what it is good for
};

/// All that a report says, in words and tables. It is made here once; the plain HTML page
/// (report_html.h) and the viewer's page both show it.
struct ReportContent {
  std::string intro;
  std::vector<CameraContent> cameras;
  std::vector<Table> tables;  ///< of all cameras together; none is empty
  std::optional<NextViewWords> next_view;
};

ReportContent ContentOf(const Report& report);

/// camera_from_lidar and its inverse.
std::vector<NamedPose> BothWays(const CameraCalibration& calibration);

NextViewWords WordsOf(const NextView& next);

}  // namespace rgbdt
