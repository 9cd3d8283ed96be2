#include "services/nodes/detector_node.h"

#include <algorithm>

#include "calib/camera/pixels.h"
#include "calib/detect/detect.h"
#include "calib/files/rig_file.h"
#include "calib/model/errors.h"

namespace rgbdt {

DetectorNode::DetectorNode(std::string method) : method_(std::move(method)) {
  RequireMethod(method_);
}

Messages DetectorNode::Handle(const Message& message) {
  if (const auto* text = std::get_if<RigText>(&message)) {
    OnRig(*text);
    return {};
  }
  if (!rig_) throw InputError("no rig heard yet; start rgbdt-session, or publish RIG");
  if (const auto* chunk = std::get_if<CloudChunk>(&message)) {
    view_.Add(*chunk);
  } else if (const auto* image = std::get_if<Image>(&message)) {
    CheckImage(rig_->Camera(image->camera), *image);
    view_.Add(*image);
  } else if (const auto* picks = std::get_if<CornerSelection>(&message)) {
    rig_->Camera(picks->camera);
    view_.Add(*picks);
  } else if (const auto* command = std::get_if<SessionCommand>(&message)) {
    OnCommand(*command);
  }
  return DetectIfComplete();
}

void DetectorNode::OnRig(const RigText& text) {
  if (rig_ && rig_->hash == text.hash) return;
  rig_ = ParseRig(text.text, "RIG message");
  view_ = {};
}

void DetectorNode::OnCommand(const SessionCommand& command) {
  if (command.verb == SessionVerb::kReset) view_.Reset();
  if (command.verb == SessionVerb::kCapture) view_.Begin(command);
}

Messages DetectorNode::DetectIfComplete() {
  if (!view_.active()) return {};
  SessionEvent event;
  event.command = view_.capture().command;
  event.utime = view_.capture().utime;
  event.source = name();
  const std::optional<View> view = view_.Take(*rig_);
  if (!view) return {};
  ++views_;
  try {
    return Detect(*view, event);
  } catch (const InputError& e) {
    event.kind = EventKind::kFailed;
    event.text = e.what();
    return {event};
  }
}

Messages DetectorNode::Detect(const View& view, SessionEvent event) {
  Messages out;
  for (Observation& observation : DetectView(*rig_, view, method_)) {
    event.utime = std::max(event.utime, observation.image_utime);
    event.text += (event.text.empty() ? "" : "; ") + observation.camera + ": " +
                  (observation.usable() ? "board found" : observation.rejected);
    if (!observation.usable()) ++rejected_;
    out.push_back(std::move(observation));
  }
  out.push_back(std::move(event));
  return out;
}

Status DetectorNode::GetStatus() const {
  Status status;
  status.ready = rig_.has_value();
  status.text = !rig_ ? "waits for the rig (RIG)"
                : !view_.active()
                    ? "waits for a capture"
                    : "view " + view_.capture().view + " waits for " + view_.Missing(*rig_);
  status.counters = {{"views", views_}, {"rejected", rejected_}};
  return status;
}

}  // namespace rgbdt
