#pragma once

#include <optional>
#include <string>

#include "calib/model/method.h"
#include "calib/model/rig.h"
#include "services/nodes/node.h"
#include "services/nodes/view_collector.h"

namespace rgbdt {

/// CLOUD + <CAMERA>_IMAGE + CORNER_SELECTION + SESSION_COMMAND capture -> OBSERVATION, one a
/// camera, then SESSION_EVENT done; or failed, where the view's parts cannot be made into one. A
/// view that never becomes complete is dropped when the next capture or a reset comes; the status
/// says what it waits for. Another rig forgets everything.
class DetectorNode : public Node {
 public:
  /// Throws InputError for an unknown method.
  explicit DetectorNode(std::string method = kAutoMethod);
  std::string name() const override { return "detector"; }
  std::vector<std::string> Subscriptions() const override {
    return {"RIG", "CLOUD", ".*_IMAGE", "CORNER_SELECTION", "SESSION_COMMAND"};
  }
  Messages Handle(const Message& message) override;
  Status GetStatus() const override;

 private:
  void OnRig(const RigText& rig);
  void OnCommand(const SessionCommand& command);
  Messages DetectIfComplete();
  Messages Detect(const View& view, SessionEvent event);

  std::string method_;
  std::optional<Rig> rig_;
  ViewCollector view_;
  std::int64_t views_ = 0;
  std::int64_t rejected_ = 0;
};

}  // namespace rgbdt
