#include "services/replay/telling_node.h"

#include "calib/model/printable.h"

namespace rgbdt {
namespace {

constexpr char kLines[] = "\n";

}  // namespace

TellingNode::TellingNode(const WaveProgress& recorded) : progress_(recorded) {
  progress_.phase = WavePhase::kSolving;
  progress_.left_s = 0;
  progress_.text = "recorded";
}

void TellingNode::Tell(const std::string& text) {
  const std::lock_guard<std::mutex> lock(mutex_);
  progress_.text = PrintableText(text, kLines);
}

void TellingNode::End(WavePhase phase, const std::string& text,
                      const std::vector<WavedClock>& clocks) {
  const std::lock_guard<std::mutex> lock(mutex_);
  progress_.phase = phase;
  progress_.text = PrintableText(text, kLines);  // a path may be none
  progress_.clocks = clocks;
}

Messages TellingNode::Advance(Utime now) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (progress_.phase == WavePhase::kSolving) {
    return second_.IsDue(now) ? Messages{progress_} : Messages{};
  }
  if (farewells_ == 0 || !farewell_.IsDue(now)) return {};
  --farewells_;
  return {progress_};
}

Status TellingNode::GetStatus() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  Status status;
  status.ready = true;
  status.text = progress_.text;
  return status;
}

}  // namespace rgbdt
