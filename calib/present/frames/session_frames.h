#pragma once

#include <string>
#include <vector>

#include "calib/files/session/session_dir.h"
#include "calib/model/calibration.h"
#include "calib/model/view_detection.h"

namespace rgbdt::viewer {

/// A frame and what it is about ("session", "thumb/0001/rgb", ...), as a live session has them.
struct NamedFrame {
  std::string topic;
  std::string bytes;
};

struct SessionFramesOptions {
  std::string title;  ///< of the page
  std::string version;
  int image_width = 960;         ///< [px] of the views' JPEGs
  std::size_t points = 100'000;  ///< of the fused cloud
  /// Of the cloud laid on each image: there are many of them in one file.
  std::size_t overlay_points = 6'000;
};

/// All panels of a finished session, in the order in which a page is to take them: hello, rig,
/// session, thumbs, each view's images and overlays, and the fused cloud of its last view that has
/// one. `detections` may be of any order; a view whose files cannot be read is shown with the
/// reason. Deterministic.
std::vector<NamedFrame> SessionFrames(const Session& session,
                                      const std::vector<ViewDetection>& detections,
                                      const Report& report, const SessionFramesOptions& options);

}  // namespace rgbdt::viewer
