#include "services/nodes/session_node.h"

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <utility>

#include "calib/files/schema/calibration_file.h"
#include "calib/files/schema/report_file.h"
#include "calib/files/session/session_dir.h"
#include "calib/model/errors.h"
#include "calib/model/text.h"
#include "calib/present/report/verdict.h"
#include "services/nodes/internal/session_steps.h"

namespace rgbdt {
namespace {

// After one that was cut off is heard: within that the others are, too.
constexpr Utime kHeardAgain = 3 * kMicrosecondsPerSecond / 2;

}  // namespace

SessionNode::SessionNode(SessionScript script, Rig rig, std::filesystem::path directory,
                         OnProgress progress, BoardStands board_stands, SessionIdentity identity)
    : script_(std::move(script)),
      rig_(std::move(rig)),
      directory_(std::move(directory)),
      progress_(std::move(progress)),
      board_stands_(std::move(board_stands)),
      identity_(std::move(identity)) {
  if (script_.steps.empty()) throw InputError("the session script has no steps");
  earlier_ = ReadEarlierViews(directory_, rig_);
  if (!earlier_.empty() || earlier_.asked) {
    resume_ = FindResumePoint(script_, earlier_, directory_);
  }
  for (SessionStep& step : script_.steps) {
    if (board_stands_ && step.kind == SessionStep::Kind::kNextPose) step.timeout_s = kPatience;
  }
}

SessionNode::SessionNode(Rig rig, std::filesystem::path directory, OnProgress progress,
                         SessionIdentity identity)
    : by_request_(true),
      rig_(std::move(rig)),
      directory_(std::move(directory)),
      progress_(std::move(progress)),
      identity_(std::move(identity)) {
  earlier_ = ReadEarlierViews(directory_, rig_);
  resume_ = FindResumePoint(earlier_);
}

Messages SessionNode::Handle(const Message& message) {
  Take(message);
  if (const auto* image = std::get_if<Image>(&message)) {
    // The clock was set back, perhaps since the views that this session goes on with.
    if (image->utime < newest_utime_ - ViewCollector::kClockReset) newest_utime_ = image->utime;
  }
  // Another process' health is no sensor's time.
  if (!std::holds_alternative<Status>(message)) {
    newest_utime_ = std::max(newest_utime_, UtimeOf(message));
  }
  SaveView();
  return {};
}

Messages SessionNode::Advance(Utime now) {
  now_ = now;
  if (!began_) began_ = now;
  if (Listens() || (finished_ && !started_)) return std::exchange(events_, {});
  Messages out, next;
  if (rig_repeat_.IsDue(now)) out.push_back(RigText{0, rig_.hash, rig_.text});
  if (unwritten_.IsDue(now)) WriteToDisk();
  try {
    AskWhetherBoardStands();
    next = GoOn();
  } catch (const std::exception& e) {  // a file that cannot be written, a person who is gone
    Fail(e.what());
  }
  for (Messages* messages : {&again_, &next, &events_}) {
    std::move(messages->begin(), messages->end(), std::back_inserter(out));
    messages->clear();
  }
  return out;
}

Messages SessionNode::GoOn() {
  if (finished_ || idle()) return {};
  if (!started_) return Start();
  if (!waiting_) return Begin();
  if (!StepDone()) {
    if (!waiting_ || finished_) return {};  // it failed
    const bool waits = step().kind == SessionStep::Kind::kWait || !unwritten_.empty();
    if (const std::string why = waits ? "" : timeout_.WhyOver(now_); !why.empty()) {
      const std::string clocks = ClockTrouble();
      const std::string what =
          why + "; " + WhatIsMissing() + WhoIsSilent() + (clocks.empty() ? "" : "; " + clocks);
      const bool lacking = answered_ || !exchange_.detector_lacks.empty();
      if (step().kind == SessionStep::Kind::kCapture && lacking) {
        TakeTornAgain(what);  // it was lost on its way
      } else {
        Fail(what);
      }
    }
    Messages said = RepeatCommand();
    for (Message& again : SayWhatIsLacking()) said.push_back(std::move(again));
    return said;
  }
  if (!finished_) EndStep();
  if (finished_ || idle()) return {};
  return Begin();
}

void SessionNode::EndStep() {
  waiting_ = false;
  const bool saved = step().kind == SessionStep::Kind::kSave;
  if (step().kind == SessionStep::Kind::kCapture) {
    view_taken_ = true;
    retakes_ = restarts_ = 0;
    exchange_ = {};
    RemoveAsked(directory_);
    solver_views_.Require(view_);
  }
  if (++index_ < script_.steps.size()) return;
  finished_ = !by_request_ || saved;
  PublishEvent(EventKind::kDone, saved ? "saved to " + directory_.string() : last_answer_, 1);
}

// A sweep without somebody who needs it is of no use.
bool SessionNode::IsHeldUp() {
  std::string who = step().kind == SessionStep::Kind::kSweep ? WhoIsNotReady() : "";
  if (step().kind == SessionStep::Kind::kSweep && who.empty()) {
    if (HasDevices()) who = ClockTrouble();
    if (clocks_set_ && now_ - *clocks_set_ < kClocksSettle && who.empty()) {
      who = "the sensors' times, as a clock was set";
    }
    if (cut_off_ && now_ - *cut_off_ < kHeardAgain) who = "all that were cut off";
  }
  if (step().kind == SessionStep::Kind::kSweep && who.empty()) {
    who = NoRoom();
    if (by_request_ && !who.empty()) {
      const bool taken = view_taken_;
      Fail("no view is taken: " + who);
      view_taken_ = taken;  // the board stands as before
      return true;
    }
  }
  if (who.empty()) {
    held_up_since_.reset();
    return false;
  }
  if (!held_up_since_) {
    held_up_since_ = now_;
    Announce("waits for: " + who);
  }
  if (ToSeconds(now_ - *held_up_since_) > step().timeout_s) {
    held_up_since_.reset();
    Fail("not ready after " + std::to_string(static_cast<int>(step().timeout_s)) + " s: " + who);
  }
  return true;
}

Messages SessionNode::Begin() {
  if (std::exchange(resume_.asked, false)) return GoOnWaiting();
  if (IsHeldUp()) return {};
  waiting_ = true;
  answered_ = false;
  timeout_.Begin(now_, step().timeout_s);
  switch (step().kind) {
    case SessionStep::Kind::kNextPose:
      view_ = ViewName(++view_number_);
      view_taken_ = false;
      Announce("asked for the next pose of the board");
      return Send(SessionVerb::kNextPose);
    case SessionStep::Kind::kSweep:
      if (view_.empty() || view_taken_) view_ = ViewName(++view_number_);
      view_taken_ = false;
      spoiled_.clear();
      exchange_ = {};
      Announce("asked for a sweep");
      return Send(SessionVerb::kSweep);
    case SessionStep::Kind::kCapture:
      return BeginCapture();
    case SessionStep::Kind::kWait:
      Announce("waiting " + std::to_string(step().wait_s) + " s");
      return {};
    case SessionStep::Kind::kSolve:
      Announce("solving");
      return Send(SessionVerb::kSolve);
    case SessionStep::Kind::kEvaluate:
      Announce("judging on the held-out views");
      return Send(SessionVerb::kEvaluate);
    case SessionStep::Kind::kSave:
      Save();
      return {};
  }
  return {};
}

// The step before this one, waits aside; nothing: it is none that sweeps.
std::optional<std::size_t> SessionNode::SweepBefore() const {
  std::size_t sweep = index_;
  while (sweep > 0 && (sweep == index_ || script_.steps[sweep].kind == SessionStep::Kind::kWait)) {
    --sweep;
  }
  if (script_.steps[sweep].kind != SessionStep::Kind::kSweep) return std::nullopt;
  return sweep;
}

// The sweep before the capture at hand, and the capture, once more.
void SessionNode::TakeAgain(std::string why, int* tries, int most) {
  collector_.GiveUp();
  exchange_ = {};
  captures_.erase(command_);
  const std::optional<std::size_t> sweep = SweepBefore();
  const bool can = sweep.has_value();
  if (!can || *tries == most) {
    Fail(why + (can ? "; given up after " + std::to_string(most + 1) + " sweeps"
                    : "; put sweep before capture, so that it can be taken again"));
    return;
  }
  for (auto image = images_.begin(); image != images_.end();) {
    image = image->second == view_ ? images_.erase(image) : std::next(image);
  }
  solver_views_.Drop(view_);
  std::error_code ignored;
  unwritten_.Drop(view_);
  if (taken_.erase(view_) != 0) std::filesystem::remove_all(directory_ / "views" / view_, ignored);
  ++*tries;
  index_ = *sweep;
  waiting_ = false;
  Tell("view " + view_ + ": " + why + "; the sweep is taken again");
}

Messages SessionNode::BeginCapture() {
  has_view_ = false;
  if (!spoiled_.empty()) {
    TakeAgain(spoiled_, &restarts_, kMaxRestarts);
    return {};
  }
  Announce("looking for the board");
  Messages out = Send(SessionVerb::kCapture);
  captures_[command_] = std::get<SessionCommand>(out.front());
  collector_.Begin(captures_[command_]);
  return out;
}

Messages SessionNode::Send(SessionVerb verb) {
  SessionCommand command;
  command.command = ++command_;
  command.utime = newest_utime_;
  command.verb = verb;
  command.view = view_;
  if (verb == SessionVerb::kSweep) command.heldout = CaptureIsHeldOut();
  if (verb == SessionVerb::kCapture) {
    command.sweep_utime = sweep_utime_;
    command.heldout = step().heldout;
    command.picked_cameras = step().picked_cameras;
  }
  if (verb == SessionVerb::kNextPose || verb == SessionVerb::kSweep ||
      verb == SessionVerb::kCapture) {
    NoteAsked(command);
  }
  newest_command_ = command;
  repeat_pause_ = kFirstRepeat;
  repeat_at_ = now_ + repeat_pause_;
  return {command};
}

// The capture that follows the sweep at hand.
bool SessionNode::CaptureIsHeldOut() const {
  for (std::size_t i = index_; i < script_.steps.size(); ++i) {
    if (script_.steps[i].kind == SessionStep::Kind::kCapture) return script_.steps[i].heldout;
  }
  return false;
}

bool SessionNode::StepDone() {
  switch (step().kind) {
    case SessionStep::Kind::kWait:
      return ToSeconds(now_ - timeout_.began()) >= step().wait_s;
    case SessionStep::Kind::kSave:
      return true;
    case SessionStep::Kind::kCapture:
      if (!answered_ || !has_view_ || !IsDetected()) return false;
      if (const std::string lost = LostHere(); !lost.empty()) TakeTornAgain(lost);
      return waiting_ && !finished_ && unwritten_.empty();
    case SessionStep::Kind::kSolve:
    case SessionStep::Kind::kEvaluate:
      return answered_ && SolverTookAll();
    default:
      return answered_;
  }
}

// So that what an earlier run found is not taken for this session's.
void SessionNode::SetEarlierResultsAside() {
  const std::string kept = SetResultsAside(directory_);
  if (!kept.empty()) Warn(kept);
}

void SessionNode::Save() {
  WriteToDisk();
  if (!unwritten_.empty()) {
    Fail(unwritten_.Trouble());
    return;
  }
  if (!report_) {
    Fail("nothing to save: no report came from the solver; put solve before save in the script");
    return;
  }
  const std::string missing = solver_views_.MissingIn(report_);
  if (!missing.empty()) {
    Fail("the newest report lacks view " + missing + "; put solve after the last capture");
    return;
  }
  const std::string kept = KeepTimings(directory_, rig_, &*report_);
  const Calibration calibration = JudgedCalibration(*report_, rig_);
  if (calibration.cameras.empty()) {
    SetEarlierResultsAside();
  } else {
    if (!kept.empty()) Warn(kept);
    WriteCalibration(directory_ / "calibration.textproto", calibration);
  }
  WriteReport(directory_ / "report.json", WithVerdicts(*report_));
  for (const CameraReport& camera : report_->cameras) {
    if (camera.calibration.solved()) continue;
    Fail("camera " + camera.calibration.camera + ": " + camera.calibration.StatusText());
    return;
  }
  if (index_ + 1 == script_.steps.size()) WriteEnded(directory_);
  ReportProgress("saved to " + directory_.string(), 1);
}

void SessionNode::Fail(const std::string& why) {
  const bool leads = by_request_ && started_;
  if (!leads) WriteToDisk();  // the last chance
  const std::string which = leads ? ""
                                  : "step " + std::to_string(index_ + 1) + " of " +
                                        std::to_string(script_.steps.size()) + ", ";
  const bool in_step = index_ < script_.steps.size() && started_;
  const bool of_next = in_step && !waiting_ && view_taken_;  // which has no name yet
  failure_ = which + (in_step ? NameOf(step().kind) : "start") +
             (view_.empty() || of_next ? "" : ", view " + view_) + ": " + why + WhatIsOnDisk();
  PublishEvent(EventKind::kFailed, failure_, 1);
  if (started_) RemoveAsked(directory_);
  finished_ = !leads;
  retakes_ = restarts_ = 0;
  if (!leads) return;
  // What was to follow is dropped; the person decides.
  index_ = script_.steps.size();
  waiting_ = false;
  view_taken_ = true;
}

// For who watches this process, and for the page.
void SessionNode::Tell(const std::string& text) {
  Warn(text);
  PublishEvent(idle() ? EventKind::kDone : EventKind::kProgress, text, 0);
}

void SessionNode::PublishEvent(EventKind kind, const std::string& text, double fraction) {
  SessionEvent event;
  event.command = command_;
  event.utime = newest_utime_;
  event.source = name();
  event.kind = kind;
  event.text = text;
  event.fraction = fraction;
  events_.push_back(std::move(event));
}

std::string SessionNode::WithView(const std::string& text) const {
  const bool of_view = step().kind == SessionStep::Kind::kNextPose ||
                       step().kind == SessionStep::Kind::kSweep ||
                       step().kind == SessionStep::Kind::kCapture;
  return (of_view ? "view " + view_ + ": " : "") + text;
}

void SessionNode::ReportProgress(const std::string& text, double fraction) {
  if (!progress_) return;
  progress_({static_cast<int>(index_) + 1, static_cast<int>(script_.steps.size()), WithView(text),
             fraction});
}

// How a step begins: for who watches this process, and for the bus.
void SessionNode::Announce(const std::string& text) {
  ReportProgress(text, 0);
  PublishEvent(EventKind::kProgress, WithView(text), 0);
}

void SessionNode::AskWhetherBoardStands() {
  if (board_stands_ && WaitsForPose() && board_stands_()) PoseIsSet();
}

Status SessionNode::GetStatus() const {
  Status status;
  status.ready = true;
  status.counters = {{"by request", by_request_},
                     {"busy", !idle() && !finished_},
                     {"waits for pose", WaitsForPose()}};
  if (!by_request_) {
    status.counters.emplace_back("step", static_cast<std::int64_t>(index_) + 1);
    status.counters.emplace_back("steps", static_cast<std::int64_t>(script_.steps.size()));
  }
  OtherSessions::Tell(identity_.id, Listens(), finished_, &status);
  status.text = finished_   ? (failure_.empty() ? "finished" : "failed: " + failure_)
                : Listens() ? "listens whether another session is on the bus"
                : !started_ ? "waits for: " + WhoIsNotReady()
                : idle()    ? "waits for a person to ask for something (SESSION_REQUEST)"
                            : "step " + std::to_string(index_ + 1) + " of " +
                               std::to_string(script_.steps.size());
  if (const std::string trouble = unwritten_.Trouble(); !trouble.empty()) {
    status.text += "; " + trouble;
  }
  // First, as another session tells no more than this text's beginning.
  if (!identity_.place.empty()) status.text = "writes " + identity_.place + "; " + status.text;
  return status;
}

}  // namespace rgbdt
