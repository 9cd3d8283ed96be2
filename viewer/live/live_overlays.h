#pragma once

#include <map>
#include <string>

#include "calib/model/calibration.h"
#include "calib/model/rig.h"
#include "calib/model/view_detection.h"
#include "viewer/live/fused_posts.h"
#include "viewer/server/outbox.h"

namespace rgbdt::viewer {

/// Who sees the board just now, and what is drawn on each camera's newest image: the board as it
/// was seen last, and the newest whole sweep. Times [s] are of a steady clock.
class LiveOverlays {
 public:
  void Add(const TargetStatus& status, double now_s);
  void Clear() { seen_.clear(); }

  /// A TargetStatusFrame (page/src/protocol.ts). `rig` may be null.
  Post TargetStatusPost(const Rig* rig, double now_s) const;
  /// An OverlayFrame.
  Post OverlayPost(const CameraSpec& camera, const Calibration& calibration,
                   const FusedPosts::Points& sweep) const;

 private:
  struct Seen {
    TargetStatus status;
    double at_s;
  };
  std::map<std::string, Seen> seen_;  // by camera; "": the LIDAR
};

}  // namespace rgbdt::viewer
