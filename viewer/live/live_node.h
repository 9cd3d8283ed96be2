#pragma once

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "calib/files/schema/calibration_use.h"
#include "calib/model/rig.h"
#include "calib/present/frames/session_state.h"
#include "services/nodes/view_collector.h"
#include "services/runtime/node.h"
#include "services/runtime/periodic.h"
#include "viewer/live/fused_posts.h"
#include "viewer/live/kept_view.h"
#include "viewer/live/live_overlays.h"
#include "viewer/live/mount_history.h"
#include "viewer/live/session_watch.h"
#include "viewer/live/wave_history.h"
#include "viewer/server/outbox.h"

namespace rgbdt::viewer {

/// All that is on the bus, as posts for browsers; what browsers ask for, as messages for the bus:
/// RIG, `<CAMERA>_IMAGE`, CLOUD, CORNER_SELECTION, DETECTION, CALIBRATION, REPORT, RGBDT_CLOUD,
/// RGBDT_SWEEP, POSE, SESSION_COMMAND, SESSION_EVENT, TARGET_STATUS, MOUNT_CHECK, WAVE_PROGRESS,
/// STATUS, LEFT_OUT_VIEWS -> SESSION_REQUEST, CORNER_SELECTION, LEFT_OUT_VIEWS. A calibration of
/// another rig is refused. Nothing large is encoded here: a post makes its bytes when a browser is
/// about to get it. Of each view its images are kept as JPEG, and some points of its cloud. Advance
/// publishes what browsers asked for, and posts the session's state where it has changed, at most
/// ten times a second. All but OnBrowser belong to the bus' thread, that to the server's.
class LiveNode : public Node {
 public:
  /// `use`: whether a calibration of another rig than RIG's is shown all the same.
  explicit LiveNode(Use use = Use::kIfSound) : use_(use) {}

  /// Where posts go from now on; it outlives the node. Before the first message.
  void PostTo(Outbox* outbox) { outbox_ = outbox; }

  /// Who else gets each message that is taken, behind it, and POSE. What it throws is a warning.
  /// Before the first message.
  void AlsoTo(std::function<void(const Message& message)> other) { other_ = std::move(other); }

  std::string name() const override { return "viewer"; }
  std::vector<std::string> Subscriptions() const override;
  Messages Handle(const Message& message) override;
  Messages Advance(Utime now) override;
  /// What a browser asks for is to be noticed.
  Utime LongestWait() const override { return 2000; }
  Status GetStatus() const override;

  /// What a browser asked for. Throws InputError where it cannot be done, in words for a person.
  std::vector<Post> OnBrowser(const nlohmann::json& message);

  /// A BusFrame but for its processes, at a time [s] of Advance's clock.
  using DescribeBus = std::function<nlohmann::json(double now_s)>;
  /// The bus is posted once a second. Before the first Advance.
  void PostBus(DescribeBus describe) { describe_bus_ = std::move(describe); }

 private:
  void Take(const Message& message);
  void RequireCamera(const std::string& camera) const;
  void PostState();
  void OnRig(const RigText& text);
  void OnCommand(const SessionCommand& command);
  void OnChunk(const CloudChunk& chunk);
  void OnImage(const Image& image);
  void OnDetection(const ViewDetection& detection);
  void ForgetRejected(const std::string& view);
  void OnCalibration(const CalibrationMessage& message);
  void OnFused(const RgbdtCloud& cloud);
  void OnTargetStatus(const TargetStatus& status);
  void OnMountCheck(const MountCheck& check);
  void OnWave(const WaveProgress& progress);
  void OnLeftOut(const std::set<std::string>& views);
  void AskToLeaveOut(const std::set<std::string>& views);
  void TellMoved(const CameraCalibration& camera);
  void CompleteView();
  void ShowCapture();
  void PostLiveOverlay(const std::string& camera);
  void CountSigma(const CameraCalibration& calibration);
  ViewState* StateOf(const std::string& view);
  std::vector<Post> PostsOf(const KeptView& view) const;

  Outbox* outbox_ = nullptr;
  std::function<void(const Message& message)> other_;
  DescribeBus describe_bus_;
  Periodic bus_{kMicrosecondsPerSecond};
  mutable std::mutex mutex_;  // guards all below
  double now_s_ = 0;          // Advance's
  Utime newest_utime_ = 0;
  Use use_;
  std::shared_ptr<const Rig> rig_, rig_before_;
  SessionState state_;
  bool changed_ = true;
  double posted_s_ = -1;
  Calibration with_all_views_;  // before the first view was left out
  SessionWatch watch_;
  ViewCollector collector_{ViewCollector::During::kForget};
  std::map<std::string, std::shared_ptr<KeptView>> views_;
  LiveOverlays overlays_;
  FusedPosts fused_;
  WaveHistory wave_;
  bool wave_changed_ = false;
  Periodic wave_due_{kMicrosecondsPerSecond / 5};
  MountHistory mounts_;
  bool mounts_changed_ = false;
  Periodic mounts_due_{kMicrosecondsPerSecond};
  Messages messages_;
};

}  // namespace rgbdt::viewer
