// What a session does where machines do not hear each other, or their clocks disagree.
#include <algorithm>
#include <cstdlib>

#include "services/messages/status_counters.h"
#include "services/nodes/session_node.h"

namespace rgbdt {

// It, or its answer, may have been lost. Nobody hurries a person who carries the board.
Messages SessionNode::RepeatCommand() {
  const bool carries = board_stands_ && step().kind == SessionStep::Kind::kNextPose;
  const bool asks = step().kind != SessionStep::Kind::kWait && !carries;
  const bool exchanges = has_view_ && !exchange_.detector_lacks.empty();  // SayWhatIsLacking does
  if (!waiting_ || finished_ || answered_ || !asks || exchanges || now_ < repeat_at_) return {};
  repeat_pause_ = std::min(2 * repeat_pause_, kLongestRepeat);
  repeat_at_ = now_ + repeat_pause_;
  return {newest_command_};
}

bool SessionNode::HasPart(const std::string& process) {
  return process == "detector" || process == "assembler" || process == "lidar" ||
         process == "motor" || process == "simulator" || process.rfind("camera-", 0) == 0;
}

// What was said since, there or here, did not come. Commands are sent again until they are
// answered.
void SessionNode::OnCutOff(const std::string& process, Utime silence) {
  cut_off_ = now_;
  repeat_pause_ = kFirstRepeat;
  repeat_at_ = std::min(repeat_at_, now_ + repeat_pause_);
  const std::string why = "rgbdt-" + process + " was cut off for " +
                          std::to_string(silence / kMicrosecondsPerSecond) + " s";
  if (!waiting_ || idle()) return;
  timeout_.AskedAgain(now_);
  const SessionStep::Kind kind = step().kind;
  if (HasPart(process) && kind == SessionStep::Kind::kSweep) spoiled_ = why;
  const bool solves = kind == SessionStep::Kind::kSolve || kind == SessionStep::Kind::kEvaluate;
  if (process == "solver" && solves) RestoreSolver(why);
  if (HasPart(process) && kind == SessionStep::Kind::kCapture && !(has_view_ && IsDetected())) {
    TakeAgain(why, &restarts_, kMaxRestarts);
  }
}

std::string SessionNode::ClockTrouble() const {
  for (const auto& [process, status] : statuses_) {
    for (const auto& [name, value] : status.counters) {
      if (name.rfind(kClockCounter, 0) != 0) continue;
      return "clocks disagree: that of host " + name.substr(sizeof kClockCounter - 1) + " is " +
             std::to_string(std::abs(value)) + " ms " + (value > 0 ? "ahead of" : "behind") +
             " that of rgbdt-" + process + "'s host; on each: sudo timedatectl set-ntp true";
    }
  }
  return {};
}

// A clock was set, or set right.
void SessionNode::OnClocks() {
  const std::string clocks = ClockTrouble();
  if (clocks == clock_told_) return;
  const bool set = clocks.empty() != clock_told_.empty();
  clock_told_ = clocks;
  if (!clocks.empty()) Warn(clocks);
  if (!set || !HasDevices() || !started_ || finished_) return;
  clocks_set_ = now_;
  held_up_since_.reset();
  if (!waiting_ || idle()) return;
  const std::string why = "a machine's clock was set meanwhile";
  if (restarts_ == kMaxRestarts) return;
  const SessionStep::Kind kind = step().kind;
  if (kind == SessionStep::Kind::kSweep || kind == SessionStep::Kind::kWait) spoiled_ = why;
  if (kind == SessionStep::Kind::kCapture && !(has_view_ && IsDetected()) && SweepBefore()) {
    TakeAgain(why, &restarts_, kMaxRestarts);
  }
}

// Simulated time is nobody's clock.
bool SessionNode::HasDevices() const {
  const auto& scanner = rig_.lidar.turned_scanner;
  return rig_.lidar.device.index() != 0 || (scanner && scanner->motor) ||
         std::any_of(rig_.cameras.begin(), rig_.cameras.end(),
                     [](const CameraSpec& camera) { return camera.device.has_value(); });
}

}  // namespace rgbdt
