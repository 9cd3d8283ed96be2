#include "services/nodes/detector_node.h"

#include <algorithm>

#include "calib/camera/pixels.h"
#include "calib/detect/target_status.h"
#include "calib/files/schema/rig_file.h"
#include "calib/methods/detect_view.h"
#include "calib/model/errors.h"

namespace rgbdt {
namespace {

constexpr Utime kLookEvery = kMicrosecondsPerSecond / 10;
constexpr Utime kLookShare = 4;  // of the time one look takes

}  // namespace

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
    Messages again = OnPicks(*picks);
    if (!again.empty()) return again;
  } else if (const auto* command = std::get_if<SessionCommand>(&message)) {
    if (command->verb == SessionVerb::kSayView) return SayAgain(*command);
    OnCommand(*command);
  }
  return DetectIfComplete();
}

void DetectorNode::OnRig(const RigText& text) {
  if (rig_ && rig_->hash == text.hash) return;
  rig_ = ParseRig(text.text, "RIG message");
  view_ = ViewCollector();
  kept_.clear();
  looked_.clear();
}

void DetectorNode::OnCommand(const SessionCommand& command) {
  if (command.verb == SessionVerb::kReset) {
    view_.Reset();
    kept_.clear();
  }
  if (command.verb == SessionVerb::kCapture) view_.Begin(command);
}

Messages DetectorNode::DetectIfComplete() {
  if (!view_.active()) return {};
  SessionEvent event;
  event.command = view_.capture().command;
  event.utime = view_.capture().utime;
  event.source = name();
  const Utime sweep = view_.capture().sweep_utime;
  if (const std::string torn = view_.sweeps().WhyTorn(sweep); !torn.empty()) {
    if (!view_.Missing(*rig_).empty() || torn_told_ == event.command) return {};
    torn_told_ = event.command;
    ++torn_sweeps_;
    event.kind = EventKind::kFailed;
    event.sweep_utime = sweep;
    event.text = torn;
    return {event};
  }
  const std::optional<View> view = view_.Take(*rig_);
  if (!view) return {};
  ++views_;
  kept_.push_back({*view, event});
  if (kept_.size() > kKeptViews) kept_.pop_front();
  return DetectOrFail(*view, event);
}

// What came more than kKeptViews views ago is gone: nothing.
Messages DetectorNode::SayAgain(const SessionCommand& asked) {
  if (said_again_ && now_ - *said_again_ < kSayEvery) return {};
  for (const Kept& kept : kept_) {
    if (kept.view.name != asked.view || kept.view.cloud.sweep_utime != asked.sweep_utime) continue;
    said_again_ = now_;
    Messages again = view_.Again(kept.view);
    for (Message& word : DetectOrFail(kept.view, kept.event)) again.push_back(std::move(word));
    return again;
  }
  return {};
}

// A person helps a view that was taken before.
Messages DetectorNode::OnPicks(const CornerSelection& picks) {
  for (Kept& kept : kept_) {
    const auto& images = kept.view.images;
    const bool its = std::any_of(images.begin(), images.end(), [&](const Image& image) {
      return image.camera == picks.camera && image.utime == picks.image_utime;
    });
    if (!its) continue;
    auto& all = kept.view.picks;
    all.erase(std::remove_if(all.begin(), all.end(),
                             [&](const CornerSelection& p) { return p.camera == picks.camera; }),
              all.end());
    all.push_back(picks);
    return DetectOrFail(kept.view, kept.event);
  }
  return {};
}

Messages DetectorNode::DetectOrFail(const View& view, SessionEvent event) {
  try {
    return Detect(view, event);
  } catch (const std::exception& e) {
    event.kind = EventKind::kFailed;
    event.text = e.what();
    return {event};
  }
}

Messages DetectorNode::Detect(const View& view, SessionEvent event) {
  ViewDetection detection = DetectView(*rig_, view, method_);
  for (const ImageDetection& image : detection.images) {
    event.utime = std::max(event.utime, image.utime);
    if (!image.usable()) ++images_without_board_;
  }
  if (detection.cloud.candidates.empty()) ++clouds_without_board_;
  event.text = BriefReport(detection);
  return {std::move(detection), std::move(event)};
}

Messages DetectorNode::Advance(Utime now) {
  now_ = now;
  if (!looked_at_) return {};
  const Utime took = now - *looked_at_;
  look_from_ = *looked_at_ + std::clamp(kLookShare * took, kLookEvery, kMicrosecondsPerSecond);
  looked_at_.reset();
  return {};
}

Messages DetectorNode::UseSpareTime(Utime now) {
  if (now < look_from_) return {};
  try {
    Messages said = LookAtNext();
    if (!said.empty()) looked_at_ = now;
    return said;
  } catch (const std::exception& e) {
    Warn(std::string("looking for the board: ") + e.what());
    return {};
  }
}

Messages DetectorNode::LookAtNext() {
  const bool has_time = !view_.active() || torn_told_ == view_.capture().command;
  if (!rig_ || !has_time) return {};
  const std::size_t sensors = rig_->cameras.size() + 1;
  for (std::size_t i = 0; i < sensors; ++i) {
    const std::size_t turn = next_look_++ % sensors;
    if (turn == rig_->cameras.size()) {
      const Utime sweep = view_.sweeps().NewestEnded();
      if (sweep == 0 || std::exchange(looked_[""], sweep) == sweep) continue;
      return {LookForTarget(*rig_, *view_.sweeps().Complete(sweep))};
    }
    const std::string& camera = rig_->cameras[turn].name;
    const Image* image = view_.Newest(camera);
    if (image == nullptr || std::exchange(looked_[camera], image->utime) == image->utime) continue;
    return {LookForTarget(*rig_, *image)};
  }
  return {};
}

std::string DetectorNode::Missing() const {
  const std::string missing = view_.Missing(*rig_);
  if (!missing.empty()) return missing;
  return "lines of sweep " + std::to_string(view_.capture().sweep_utime);
}

Status DetectorNode::GetStatus() const {
  Status status;
  status.ready = rig_.has_value();
  status.text = !rig_            ? "waits for the rig (RIG)"
                : view_.active() ? "view " + view_.capture().view + " waits for " + Missing()
                                 : "waits for a capture";
  status.counters = {{"views", views_},
                     {"images without board", images_without_board_},
                     {"clouds without board", clouds_without_board_},
                     {"sweeps not whole", torn_sweeps_}};
  return status;
}

}  // namespace rgbdt
