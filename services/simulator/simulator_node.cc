#include "services/simulator/simulator_node.h"

#include <algorithm>
#include <charconv>

#include "calib/model/errors.h"

namespace rgbdt {
namespace {

constexpr Utime kSecond = kMicrosecondsPerSecond;
constexpr Utime kLongestGap = 10 * kSecond;

// Which of the places in a row it is that a session's view "0003" has; -1: its name does not tell.
int PlaceOf(const std::string& view) {
  int number = 0;
  const char* end = view.data() + view.size();
  const auto [rest, error] = std::from_chars(view.data(), end, number);
  return error == std::errc() && rest == end && number > 0 ? number - 1 : -1;
}

}  // namespace

SimulatorNode::SimulatorNode(const simulate::Options& options, double speed, OnTruth on_truth)
    : simulator_(options), on_truth_(std::move(on_truth)), pacer_(speed) {}

// Read-out and transfer of the slowest camera.
Utime SimulatorNode::Delay() const {
  Utime delay = 0;
  for (const CameraSpec& camera : simulator_.rig().cameras) {
    delay = std::max(delay, FromSeconds(camera.readout_s));
  }
  return delay;
}

Messages SimulatorNode::Handle(const Message& message) {
  const auto* command = std::get_if<SessionCommand>(&message);
  if (command == nullptr) return {};
  switch (command->verb) {
    case SessionVerb::kNextPose:
      PlanPose(*command);
      break;
    case SessionVerb::kSweep:
      PlanSweep(*command);
      break;
    case SessionVerb::kCapture:
      PlanCapture(*command);
      break;
    case SessionVerb::kReset:
      views_ = 0;
      break;
    default:
      break;
  }
  return {};
}

void SimulatorNode::PlanEvent(Utime due, std::int64_t command, EventKind kind,
                              const std::string& text, Utime sweep_utime, double fraction) {
  Task task;
  task.kind = Task::Kind::kEvent;
  task.utime = due;
  task.command = command;
  task.event = kind;
  task.text = text;
  task.sweep_utime = sweep_utime;
  task.fraction = fraction;
  At(due, std::move(task));
}

void SimulatorNode::PlanShow(Utime begin, const std::string& view) {
  Task show;
  show.kind = Task::Kind::kShow;
  show.text = view;
  At(begin + 1, std::move(show));
}

void SimulatorNode::PlanImages(Utime from, Utime to) {
  for (Utime utime = (from / kSecond + 1) * kSecond; utime <= to; utime += kSecond) {
    Task task;
    task.kind = Task::Kind::kImages;
    task.utime = utime;
    At(utime + Delay(), std::move(task));
  }
}

// Not before what the session knows: one that was started anew in the midst of a session would make
// sweeps of the names once more that earlier ones had.
Utime SimulatorNode::BeginOf(const SessionCommand& command) const {
  return std::max({now_, newest_planned_, command.utime});
}

// The board is carried to its next place; the cameras see it there before the scanner turns.
void SimulatorNode::PlanPose(const SessionCommand& command) {
  const Utime begin = BeginOf(command);
  const Utime end = begin + 2 * kSecond;
  PlanEvent(begin, command.command, EventKind::kProgress, "carrying the board to its next place", 0,
            0);
  PlanShow(begin, command.view);
  PlanImages(begin, end);
  newest_planned_ = end + kSecond / 10;
  PlanEvent(newest_planned_, command.command, EventKind::kDone, "the board stands", 0, 1);
}

void SimulatorNode::PlanSweep(const SessionCommand& command) {
  Utime begin = BeginOf(command);
  if (views_ == 0 && now_ == kEpoch && command.utime > now_) {  // started anew: the board stands
    PlanShow(begin, command.view);
    begin += kSecond / 10;
  }
  const Utime sweep = begin + kSecond / 10;
  const Utime sweep_end = sweep + simulator_.sweep_lines() * simulator_.line_period();
  const Utime end = sweep_end + kSecond / 4;
  for (Utime utime = begin; utime <= end; utime += kEncoderPeriod) {
    Task reading;
    reading.kind = Task::Kind::kEncoder;
    reading.utime = utime;
    reading.sweep_utime = utime >= sweep && utime <= sweep_end ? sweep : 0;
    At(utime, std::move(reading));
  }
  for (int line = 0; line < simulator_.sweep_lines(); ++line) {
    Task task;
    task.kind = Task::Kind::kLine;
    task.line = line;
    task.sweep_utime = sweep;
    const Utime due = sweep + (line + 1) * simulator_.line_period();
    At(due, std::move(task));
    if (line % 25 == 24) {
      PlanEvent(due, command.command, EventKind::kProgress, "sweeping", sweep,
                (line + 1.0) / simulator_.sweep_lines());
    }
  }
  PlanImages(begin, sweep_end);
  newest_planned_ = end + Delay();
  PlanEvent(newest_planned_, command.command, EventKind::kDone, "sweep complete", sweep, 1);
}

void SimulatorNode::PlanCapture(const SessionCommand& command) {
  const Utime utime = BeginOf(command);
  Task images;
  images.kind = Task::Kind::kImages;
  images.utime = utime;
  At(utime + Delay(), std::move(images));
  newest_planned_ = utime + Delay();
  for (const std::string& camera : command.picked_cameras) {
    Task picks;
    picks.kind = Task::Kind::kPicks;
    picks.utime = utime;
    picks.text = camera;
    newest_planned_ += kSecond / 10;
    At(newest_planned_, std::move(picks));
  }
  PlanEvent(newest_planned_, command.command, EventKind::kDone, "images taken", 0, 1);
}

Messages SimulatorNode::Advance(Utime now) {
  Messages out;
  while (!agenda_.empty()) {
    const auto next = agenda_.begin();
    // A capture may be asked for at another clock's time: nobody waits years for it.
    if (next->first - now_ > kLongestGap) pacer_.Restart();
    if (pacer_.WaitFor(next->first, now) > 0) break;
    now_ = next->first;
    const Task task = std::move(next->second);
    agenda_.erase(next);
    try {
      for (Message& message : Do(task)) out.push_back(std::move(message));
    } catch (const std::exception& e) {
      Warn(e.what());
    }
  }
  return out;
}

void SimulatorNode::ShowView(const std::string& view) {
  const int place = std::max(views_, PlaceOf(view));
  views_ = place + 1;
  simulator_.ShowView(place, view);
  if (on_truth_) on_truth_(simulator_.truth());
}

Messages SimulatorNode::Do(const Task& task) {
  switch (task.kind) {
    case Task::Kind::kShow:
      ShowView(task.text);
      return {};
    case Task::Kind::kEncoder:
      return {simulator_.Encoder(task.utime, task.sweep_utime)};
    case Task::Kind::kLine:
      return {simulator_.Line(task.sweep_utime, task.line)};
    case Task::Kind::kImages: {
      Messages images;
      for (const CameraSpec& camera : simulator_.rig().cameras) {
        images.push_back(simulator_.TakeImage(camera.name, task.utime));
      }
      return images;
    }
    case Task::Kind::kPicks:
      return {simulator_.PickCorners(task.text, task.utime)};
    case Task::Kind::kEvent: {
      SessionEvent event;
      event.command = task.command;
      event.utime = now_;
      event.source = name();
      event.kind = task.event;
      event.text = task.text;
      event.sweep_utime = task.sweep_utime;
      event.fraction = task.fraction;
      return {event};
    }
  }
  return {};
}

Status SimulatorNode::GetStatus() const {
  Status status;
  status.ready = true;
  status.text = agenda_.empty() ? "time stands still, waits for a command" : "simulating";
  status.counters = {{"views", views_}};
  return status;
}

}  // namespace rgbdt
