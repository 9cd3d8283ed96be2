#pragma once

#include <string>
#include <vector>

#include "calib/files/session/session_dir.h"
#include "calib/model/calibration.h"
#include "calib/model/view_detection.h"
#include "calib/present/frames/page.h"
#include "calib/present/frames/session_state.h"

namespace rgbdt {

struct SessionFramesOptions {
  std::string title;                   ///< of the page
  int image_width = 960;               ///< [px] of the views' JPEGs
  std::size_t points = 100'000;        ///< of the last view's cloud, shown first; 0: none
  std::size_t other_points = 250'000;  ///< of the other views' clouds together
  /// Of the cloud laid on each image: there are many of them in one file.
  std::size_t overlay_points = 6'000;
};

/// A session that is over: its views, what was detected in them, and its result.
struct FinishedSession {
  const Session& session;
  const std::vector<ViewDetection>& detections;  ///< of any order
  /// calib/methods/calibrate_by_views.h: with the first view, the first two, ... The last is the
  /// result.
  const std::vector<Report>& reports;
  LeftOut left_out{};  ///< of the result

  const Report& report() const { return reports.back(); }
};

/// All panels of a finished session, in the order in which a page is to take them: hello, rig,
/// session, thumbs, each view's images and overlays, each camera's picture of its projection
/// uncertainty, and each view's fused cloud. A view whose files cannot be read is shown with the
/// reason. Deterministic.
std::vector<NamedFrame> SessionFrames(const FinishedSession& finished,
                                      const SessionFramesOptions& options);

/// What of it changes where the result does, with the views' files left alone: session, and each
/// camera's picture of its projection uncertainty.
std::vector<NamedFrame> ResultFrames(const FinishedSession& finished);

/// A view's fused cloud, thinned to so many points; empty: no point returned.
std::string ViewCloudFrame(const Session& session, const Calibration& calibration, const View& view,
                           std::size_t points);

}  // namespace rgbdt
