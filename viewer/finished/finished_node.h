#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "calib/files/session/session_dir.h"
#include "calib/model/calibration.h"
#include "calib/model/view_detection.h"
#include "calib/present/frames/session_state.h"
#include "viewer/server/outbox.h"

namespace rgbdt::viewer {

/// A session directory as posts for browsers. A browser may leave views out or take them back: the
/// session is solved again without them, and the new result is posted to all. Nothing is written.
/// OnBrowser may be called from another thread.
class FinishedNode {
 public:
  /// `report`: of the session with all its views. `another_rig`: why it is another rig's, whose
  /// views cannot be solved again; empty: it is this one's.
  FinishedNode(Session session, std::vector<ViewDetection> detections, const Report& report,
               const std::string& another_rig = "");

  /// Posts everything: reads each view once. `outbox` outlives the node's use. `title` is the
  /// page's.
  void PostTo(Outbox* outbox, const std::string& title);

  /// What a browser asked for: "view" is answered with that view's fused cloud, "leave_out" names
  /// all views that are to be left out. Throws InputError where it cannot be done, in words for a
  /// person.
  std::vector<Post> OnBrowser(const nlohmann::json& message);

 private:
  class Points;

  Calibration Result() const { return reports_.back().ToCalibration(); }
  void RequireView(const std::string& view) const;
  void LeaveOut(const std::set<std::string>& views);
  void PostResult();
  Post CloudPost(const std::string& view) const;
  std::vector<Post> OverlayPosts(const ViewDetection& detection) const;

  const Session session_;
  const std::vector<ViewDetection> detections_;
  std::map<std::string, std::shared_ptr<Points>> points_;  // by view
  std::vector<Report> all_views_;  // calib/methods/calibrate_by_views.h: with all views
  std::mutex mutex_;               // guards all below
  Outbox* outbox_ = nullptr;
  std::vector<Report> reports_;  // without those that are left out
  LeftOut left_out_;
};

}  // namespace rgbdt::viewer
