#include "services/nodes/session_node.h"

#include <cstdio>

#include "calib/camera/pixels.h"
#include "calib/files/calibration_file.h"
#include "calib/files/report_file.h"
#include "calib/files/session_dir.h"
#include "calib/model/errors.h"

namespace rgbdt {
namespace {

constexpr double kStartTimeout = 30;  // s, until everybody is ready

std::string ViewName(int number) {
  char name[16];
  std::snprintf(name, sizeof(name), "%04d", number);
  return name;
}

// Whose done ends a step; empty: anybody's.
std::string AnsweredBy(SessionStep::Kind kind) {
  switch (kind) {
    case SessionStep::Kind::kCapture:
      return "detector";
    case SessionStep::Kind::kSolve:
    case SessionStep::Kind::kEvaluate:
      return "solver";
    default:
      return "";
  }
}

std::string NameOf(SessionStep::Kind kind) {
  switch (kind) {
    case SessionStep::Kind::kNextPose:
      return "next pose";
    case SessionStep::Kind::kSweep:
      return "sweep";
    case SessionStep::Kind::kCapture:
      return "capture";
    case SessionStep::Kind::kWait:
      return "wait";
    case SessionStep::Kind::kSolve:
      return "solve";
    case SessionStep::Kind::kEvaluate:
      return "evaluate";
    case SessionStep::Kind::kSave:
      return "save";
  }
  return "";
}

}  // namespace

SessionNode::SessionNode(SessionScript script, Rig rig, std::filesystem::path directory,
                         OnProgress progress)
    : script_(std::move(script)),
      rig_(std::move(rig)),
      directory_(std::move(directory)),
      progress_(std::move(progress)) {
  if (script_.steps.empty()) throw InputError("the session script has no steps");
  std::error_code ignored;
  const std::filesystem::path views = directory_ / "views";
  if (std::filesystem::exists(views, ignored) && !std::filesystem::is_empty(views, ignored)) {
    throw InputError(views.string() +
                     " holds views of an earlier session; remove them or name another directory");
  }
}

Messages SessionNode::Handle(const Message& message) {
  Take(message);
  // Another process' health is no sensor's time.
  if (!std::holds_alternative<Status>(message)) {
    newest_utime_ = std::max(newest_utime_, UtimeOf(message));
  }
  SaveView();
  return {};
}

void SessionNode::Take(const Message& message) {
  if (const auto* status = std::get_if<Status>(&message)) {
    statuses_[status->process] = *status;
  } else if (const auto* event = std::get_if<SessionEvent>(&message)) {
    OnEvent(*event);
  } else if (const auto* chunk = std::get_if<CloudChunk>(&message)) {
    collector_.Add(*chunk);
  } else if (const auto* image = std::get_if<Image>(&message)) {
    CheckImage(rig_.Camera(image->camera), *image);
    collector_.Add(*image);
  } else if (const auto* picks = std::get_if<CornerSelection>(&message)) {
    rig_.Camera(picks->camera);
    collector_.Add(*picks);
  } else if (const auto* report = std::get_if<ReportText>(&message)) {
    report_ = *report;
  }
}

void SessionNode::OnEvent(const SessionEvent& event) {
  if (!waiting_ || event.command != command_) return;
  if (event.kind == EventKind::kFailed) {
    Fail(event.source + ": " + event.text);
    return;
  }
  if (event.kind == EventKind::kProgress) {
    Say(event.text, event.fraction);
    return;
  }
  const std::string wanted = AnsweredBy(step().kind);
  if (!wanted.empty() && event.source != wanted) return;
  answered_ = true;
  if (event.sweep_utime != 0) sweep_utime_ = event.sweep_utime;
  Say(event.text, 1);
}

void SessionNode::SaveView() {
  if (finished_ || !collector_.active()) return;
  const auto view = collector_.Take(rig_);
  if (!view) return;
  try {
    WriteView(directory_, *view);
    view_saved_ = true;
  } catch (const InputError& e) {
    Fail(e.what());
  }
}

Messages SessionNode::Advance(double wall_s) {
  now_s_ = wall_s;
  if (finished_) return {};
  if (!started_) {
    const std::string who = WhoIsNotReady();
    if (!who.empty()) {
      if (wall_s > kStartTimeout) Fail("not ready after 30 s: " + who);
      return {};
    }
    started_ = true;
    WriteRig(directory_, rig_);
    Messages out = Send(SessionVerb::kReset);
    for (Message& message : Begin()) out.push_back(std::move(message));
    return out;
  }
  if (waiting_ && !StepDone()) {
    const bool waits = step().kind == SessionStep::Kind::kWait;
    if (!waits && wall_s - step_began_s_ > step().timeout_s) {
      Fail("no answer in " + std::to_string(static_cast<int>(step().timeout_s)) + " s; " +
           WhatIsMissing());
    }
    return {};
  }
  if (finished_) return {};
  waiting_ = false;
  if (++index_ >= script_.steps.size()) {
    finished_ = true;
    return {};
  }
  return Begin();
}

Messages SessionNode::Begin() {
  waiting_ = true;
  answered_ = false;
  step_began_s_ = now_s_;
  switch (step().kind) {
    case SessionStep::Kind::kNextPose:
      view_ = ViewName(++view_number_);
      Say("asked for the next pose of the board", 0);
      return Send(SessionVerb::kNextPose);
    case SessionStep::Kind::kSweep:
      if (view_.empty()) view_ = ViewName(++view_number_);
      Say("asked for a sweep", 0);
      return Send(SessionVerb::kSweep);
    case SessionStep::Kind::kCapture:
      return BeginCapture();
    case SessionStep::Kind::kWait:
      Say("waiting " + std::to_string(step().wait_s) + " s", 0);
      return {};
    case SessionStep::Kind::kSolve:
      Say("solving", 0);
      return Send(SessionVerb::kSolve);
    case SessionStep::Kind::kEvaluate:
      Say("judging on the held-out views", 0);
      return Send(SessionVerb::kEvaluate);
    case SessionStep::Kind::kSave:
      Save();
      return {};
  }
  return {};
}

Messages SessionNode::BeginCapture() {
  view_saved_ = false;
  Say("looking for the board", 0);
  Messages out = Send(SessionVerb::kCapture);
  collector_.Begin(std::get<SessionCommand>(out.front()));
  return out;
}

Messages SessionNode::Send(SessionVerb verb) {
  SessionCommand command;
  command.command = ++command_;
  command.utime = newest_utime_;
  command.verb = verb;
  command.view = view_;
  if (verb == SessionVerb::kCapture) {
    command.sweep_utime = sweep_utime_;
    command.heldout = step().heldout;
    command.picked_cameras = step().picked_cameras;
  }
  return {command};
}

bool SessionNode::StepDone() {
  switch (step().kind) {
    case SessionStep::Kind::kWait:
      return now_s_ - step_began_s_ >= step().wait_s;
    case SessionStep::Kind::kSave:
      return true;
    case SessionStep::Kind::kCapture:
      return answered_ && view_saved_;
    default:
      return answered_;
  }
}

void SessionNode::Save() {
  if (!report_) {
    Fail("nothing to save: no report came from the solver; put solve before save in the script");
    return;
  }
  const Report report = ReportFromJson(report_->json);
  WriteReport(directory_ / "report.json", report);
  const Calibration calibration = report.ToCalibration();
  if (!calibration.cameras.empty()) {
    WriteCalibration(directory_ / "calibration.textproto", calibration);
  }
  for (const CameraReport& camera : report.cameras) {
    if (camera.solved()) continue;
    Fail("camera " + camera.calibration.camera + ": " + camera.calibration.status);
    return;
  }
  Say("saved to " + directory_.string(), 1);
}

void SessionNode::Fail(const std::string& why) {
  failure_ = "step " + std::to_string(index_ + 1) + " of " + std::to_string(script_.steps.size()) +
             ", " + (started_ ? NameOf(step().kind) : "start") +
             (view_.empty() ? "" : ", view " + view_) + ": " + why;
  finished_ = true;
}

void SessionNode::Say(const std::string& text, double fraction) {
  if (!progress_) return;
  const bool of_view = step().kind == SessionStep::Kind::kNextPose ||
                       step().kind == SessionStep::Kind::kSweep ||
                       step().kind == SessionStep::Kind::kCapture;
  progress_({static_cast<int>(index_) + 1, static_cast<int>(script_.steps.size()),
             (of_view ? "view " + view_ + ": " : "") + text, fraction});
}

bool SessionNode::WaitsForPose() const {
  return waiting_ && !answered_ && step().kind == SessionStep::Kind::kNextPose;
}

void SessionNode::PoseIsSet() {
  if (WaitsForPose()) answered_ = true;
}

// Processes without which a session leads nowhere.
std::vector<std::string> SessionNode::Needed() const {
  std::vector<std::string> needed = {"assembler", "detector", "solver", "fuser"};
  for (const CameraSpec& camera : rig_.cameras) {
    if (camera.device) needed.push_back("camera-" + camera.name);
  }
  if (rig_.lidar.device.index() != 0) needed.push_back("lidar");
  if (rig_.lidar.turned_scanner && rig_.lidar.turned_scanner->motor) needed.push_back("motor");
  return needed;
}

std::string SessionNode::WhoIsNotReady() const {
  std::string who;
  for (const std::string& process : Needed()) {
    const auto found = statuses_.find(process);
    if (found != statuses_.end() && found->second.ready) continue;
    who += (who.empty() ? "" : ", ") + std::string("rgbdt-") + process +
           (found == statuses_.end() ? " (not heard)" : " (" + found->second.text + ")");
  }
  return who;
}

std::string SessionNode::WhatIsMissing() const {
  const std::string wanted = AnsweredBy(step().kind);
  if (answered_) return "this process still lacks " + collector_.Missing(rig_);
  const auto found = statuses_.find(wanted);
  if (step().kind == SessionStep::Kind::kNextPose) {
    return "nobody said that the board stands; where you carry it: rgbdt-session --by-hand";
  }
  if (wanted.empty()) {
    return "is rgbdt-motor, rgbdt-lidar (or rgbdt-simulator) running, whichever turns or sweeps?";
  }
  if (found == statuses_.end()) return "rgbdt-" + wanted + " was not heard; is it running?";
  return "rgbdt-" + wanted + " says: " + found->second.text +
         (found->second.last_problem.empty() ? ""
                                             : "; last problem: " + found->second.last_problem);
}

Messages SessionNode::Republish() { return {RigText{0, rig_.hash, rig_.text}}; }

Status SessionNode::GetStatus() const {
  Status status;
  status.ready = true;
  status.text = finished_   ? (failure_.empty() ? "finished" : "failed: " + failure_)
                : !started_ ? "waits for: " + WhoIsNotReady()
                            : "step " + std::to_string(index_ + 1) + " of " +
                                  std::to_string(script_.steps.size());
  return status;
}

}  // namespace rgbdt
