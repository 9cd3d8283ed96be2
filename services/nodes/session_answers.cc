// What a session hears, and what it has not heard.
#include <algorithm>

#include "calib/camera/pixels.h"
#include "calib/files/schema/report_file.h"
#include "calib/model/errors.h"
#include "services/messages/status_counters.h"
#include "services/nodes/internal/session_steps.h"
#include "services/nodes/session_node.h"

namespace rgbdt {

namespace {

constexpr Utime kSilence = 5 * kMicrosecondsPerSecond;  // every STATUS comes at 1 Hz

// Besides those that are needed: strangers make up names.
constexpr std::size_t kMostProcesses = 100;

constexpr std::int64_t kMissedWords = 3;  // of a process that was cut off, at 1 Hz

// It counts from 0 again. A datagram may come twice.
bool IsStartedAnew(const Status& before, const Status& now) {
  return now.seq < before.seq || CounterOf(now, "received") < CounterOf(before, "received");
}

}  // namespace

void SessionNode::Take(const Message& message) {
  if (const auto* status = std::get_if<Status>(&message)) {
    OnStatus(*status);
  } else if (const auto* event = std::get_if<SessionEvent>(&message)) {
    OnEvent(*event);
  } else if (const auto* request = std::get_if<SessionRequest>(&message)) {
    OnRequest(*request);
  } else if (const auto* chunk = std::get_if<CloudChunk>(&message)) {
    collector_.Add(*chunk);
  } else if (const auto* image = std::get_if<Image>(&message)) {
    CheckImage(rig_.Camera(image->camera), *image);
    collector_.Add(*image);
  } else if (const auto* picks = std::get_if<CornerSelection>(&message)) {
    rig_.Camera(picks->camera);
    OnPicks(*picks);
    collector_.Add(*picks);
  } else if (const auto* detection = std::get_if<ViewDetection>(&message)) {
    if (!IsCaptured(*detection)) return;
    newly_detected_.insert(detection->view);
    solver_views_.Add(*detection);
    SaveDetection(detection->view);
  } else if (const auto* left_out = std::get_if<LeftOutViews>(&message)) {
    if (started_) SaveLeftOut(*left_out);
  } else if (const auto* report = std::get_if<ReportText>(&message)) {
    report_ = ReportFromJson(report->json, "REPORT message");
  }
}

bool SessionNode::Listens() const {
  return identity_.listen > 0 && (!began_ || now_ - *began_ < identity_.listen);
}

void SessionNode::OnStatus(const Status& status) {
  const auto before = statuses_.find(status.process);
  const bool known = before != statuses_.end();
  bool keeps = true;
  const bool anew = known && IsStartedAnew(before->second, status);
  const Utime silence = known ? now_ - heard_.at(status.process) : 0;
  // One that is at work is silent, too, but says no less for it.
  const bool cut_off =
      known && !anew && silence > kCutOff && status.seq - before->second.seq >= kMissedWords;
  if (!known && statuses_.size() >= kMostProcesses) {
    const std::vector<std::string> needed = Needed();
    keeps = std::find(needed.begin(), needed.end(), status.process) != needed.end();
  }
  if (keeps) {
    statuses_[status.process] = status;
    heard_[status.process] = now_;
  }
  if (anew && started_ && !finished_) OnStartedAnew(status.process);
  if (cut_off && started_ && !finished_) OnCutOff(status.process, silence);
  OnClocks();
  if (status.process == "solver" && solver_views_.LostBy(status)) {
    RestoreSolver("rgbdt-solver was started anew and has lost its views");
  }
  if (finished_) return;
  if (!Listens()) {
    if (const auto warning = others_.Warning(status)) Tell(*warning);
  } else if (const auto why = others_.WhyGiveWay(status)) {
    failure_ = "start: " + *why;
    finished_ = true;  // no event: the page would take it for one of the other session
  }
}

// What it was asked, and what it had of the view at hand, is lost. A sweep that others make goes on
// to its end before it is made again.
void SessionNode::OnStartedAnew(const std::string& process) {
  const std::string why = "rgbdt-" + process + " was started anew";
  const bool assembles = process == "assembler" && rig_.lidar.turned_scanner;
  const bool has_lines = assembles || process == "lidar" || process == "simulator";
  const bool has_images = process == "simulator" || process.rfind("camera-", 0) == 0;
  if (has_lines) spoiled_ = why;
  if (process == "detector") OnDetectorStartedAnew(why);
  if (!waiting_ || idle()) return;
  switch (step().kind) {
    case SessionStep::Kind::kNextPose:
      if (process == "simulator" && !answered_) AskAgain(why);
      return;
    case SessionStep::Kind::kSweep:
      if (AnswersSweeps(process) && !answered_) AskAgain(why);
      return;
    case SessionStep::Kind::kCapture: {
      const bool swept = collector_.sweeps().Ended(sweep_utime_);
      if ((has_images && !has_view_) || (has_lines && !swept)) {
        TakeAgain(why, &restarts_, kMaxRestarts);
      }
      return;
    }
    default:
      return;
  }
}

bool SessionNode::AnswersSweeps(const std::string& process) const {
  const auto& scanner = rig_.lidar.turned_scanner;
  if (process == "simulator") return true;
  if (scanner) return scanner->motor && process == "motor";  // or somebody else's motor turns it
  return process == "lidar";
}

// The step at hand, once everybody is ready.
void SessionNode::AskAgain(const std::string& why) {
  if (restarts_ == kMaxRestarts) {
    Fail(why + " " + std::to_string(restarts_ + 1) + " times; see what it prints");
    return;
  }
  ++restarts_;
  waiting_ = false;
  if (step().kind == SessionStep::Kind::kNextPose) --view_number_;  // the same view's
  Tell(WithView(why + "; it is asked again"));
}

void SessionNode::OnRequest(const SessionRequest& request) {
  if (request.request == SessionRequestKind::kPoseIsSet) {
    PoseIsSet();
    return;
  }
  if (!by_request_) throw InputError("a script leads this session; what is asked for is not done");
  if (Listens()) throw InputError("the session has not begun: it listens for another one");
  if (!started_) throw InputError("the session waits for: " + WhoIsNotReady());
  if (!idle()) {
    WriteToDisk();
    const std::string trouble = unwritten_.Trouble();
    throw InputError("the session is busy; ask again when it is done" +
                     (trouble.empty() ? "" : "; " + trouble));
  }
  failure_.clear();
  switch (request.request) {
    case SessionRequestKind::kNextPose:
      Append(SessionStep::Kind::kNextPose);
      break;
    case SessionRequestKind::kCapture:
      AppendCapture(request.heldout);
      break;
    case SessionRequestKind::kFinish:
      Append(SessionStep::Kind::kEvaluate);
      Append(SessionStep::Kind::kSave);
      break;
    case SessionRequestKind::kPoseIsSet:
      break;
  }
}

void SessionNode::Append(SessionStep::Kind kind, bool heldout) {
  SessionStep step;
  step.kind = kind;
  step.heldout = heldout;
  if (kind == SessionStep::Kind::kNextPose) step.timeout_s = kPatience;
  script_.steps.push_back(std::move(step));
}

void SessionNode::AppendCapture(bool heldout) {
  Append(SessionStep::Kind::kSweep);
  Append(SessionStep::Kind::kCapture, heldout);
  Append(SessionStep::Kind::kSolve);
  Append(SessionStep::Kind::kEvaluate);
}

void SessionNode::OnEvent(const SessionEvent& event) {
  if (event.source == name()) return;
  const auto capture = captures_.find(event.command);
  const bool of_capture = event.source == "detector" && capture != captures_.end();
  // Without a DETECTION its last word is said again (AnsweredCommands).
  const bool detected = of_capture && newly_detected_.erase(capture->second.view) != 0;
  if (of_capture && event.command != command_) {
    if (!detected && event.kind == EventKind::kDone) return;
    PublishEvent(event.kind, "view " + capture->second.view + ", once more: " + event.text, 1);
    if (!by_request_ || finished_ || event.kind != EventKind::kDone) return;
    Append(SessionStep::Kind::kSolve);
    Append(SessionStep::Kind::kEvaluate);
    return;
  }
  if (!waiting_ || event.command != command_) return;
  repeat_pause_ = kFirstRepeat;
  repeat_at_ = now_ + repeat_pause_;
  if (event.kind == EventKind::kFailed) {
    const std::string why = event.source + ": " + event.text;
    if (event.source == "solver" && RestoreSolver("rgbdt-" + why)) return;
    if (event.source == "detector" && event.sweep_utime != 0) {
      exchange_.detector_lacks = why;
      exchange_.next_try = now_;
    } else {
      Fail(why);
    }
    return;
  }
  if (event.kind == EventKind::kProgress) {
    timeout_.OnProgress(event.source, event.fraction);
    ReportProgress(event.text, event.fraction);
    return;
  }
  const std::string wanted = AnsweredBy(step().kind);
  if (!wanted.empty() && event.source != wanted) return;
  if (!std::exchange(answered_, true)) exchange_.next_try = now_ + kMicrosecondsPerSecond;
  last_answer_ = event.text;
  if (event.sweep_utime != 0) sweep_utime_ = event.sweep_utime;
  ReportProgress(event.text, 1);
}

// One that was started anew answers from what it has heard since.
bool SessionNode::SolverTookAll() {
  const std::string missing = solver_views_.MissingIn(report_);
  if (missing.empty()) return true;
  const std::string why = "rgbdt-solver's report lacks view " + missing;
  if (!RestoreSolver(why)) Fail(why);
  return false;
}

// False: nothing to give it, or it was of no use.
bool SessionNode::RestoreSolver(const std::string& why) {
  Messages again = solver_views_.Again();
  if (again.empty()) return false;
  if (waiting_ && AnsweredBy(step().kind) == "solver") {
    answered_ = false;
    timeout_.AskedAgain(now_);
    newest_command_.command = ++command_;  // the answer to the one before is of no use
    again.emplace_back(newest_command_);
  }
  again_ = std::move(again);
  Warn(why + "; all views are sent to it again");
  return true;
}

bool SessionNode::IsDetected() const {
  const ViewDetection* detection = solver_views_.Find(view_);
  return detection != nullptr && IsCaptured(*detection);
}

// Of the view at hand, which detector and this process have each put together; empty: nothing. Of
// the images from during the sweep one is as good as another.
std::string SessionNode::LostHere() const {
  const Utime asked = captures_.at(command_).utime;
  for (const ImageDetection& image : solver_views_.Find(view_)->images) {
    if (image.utime < asked || images_.count({image.camera, image.utime}) != 0) continue;
    return "the image of camera " + image.camera + " that rgbdt-detector has was lost on its way";
  }
  return {};
}

// By this session: another one's views are called the same.
bool SessionNode::IsCaptured(const ViewDetection& detection) const {
  return std::any_of(captures_.begin(), captures_.end(), [&](const auto& capture) {
    return capture.second.view == detection.view &&
           capture.second.sweep_utime == detection.sweep_utime;
  });
}

bool SessionNode::WaitsForPose() const {
  return waiting_ && !answered_ && step().kind == SessionStep::Kind::kNextPose;
}

void SessionNode::PoseIsSet() {
  if (WaitsForPose()) answered_ = true;
}

// Processes without which a session leads nowhere.
std::vector<std::string> SessionNode::Needed() const {
  std::vector<std::string> needed = {"detector", "solver", "fuser"};
  if (rig_.lidar.turned_scanner) needed.emplace_back("assembler");
  for (const CameraSpec& camera : rig_.cameras) {
    if (camera.device) needed.push_back("camera-" + camera.name);
  }
  if (rig_.lidar.device.index() != 0) needed.emplace_back("lidar");
  if (rig_.lidar.turned_scanner && rig_.lidar.turned_scanner->motor) needed.emplace_back("motor");
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

// One that is gone need not be the one that is waited for.
std::string SessionNode::WhoIsSilent() const {
  std::string who;
  for (const std::string& process : Needed()) {
    const auto heard = heard_.find(process);
    const Utime silence = heard == heard_.end() ? 0 : now_ - heard->second;
    if (heard != heard_.end() && silence <= kCutOff) continue;
    who += (who.empty() ? "; silent, as they are gone or at work: rgbdt-" : ", rgbdt-") + process;
    if (silence > 0) who += " for " + std::to_string(silence / kMicrosecondsPerSecond) + " s";
  }
  return who;
}

std::string SessionNode::WhatIsMissing() const {
  const std::string wanted = AnsweredBy(step().kind);
  if (answered_ && has_view_) return "this process still lacks the view's DETECTION";
  if (answered_ && !exchange_.torn_here.empty()) return exchange_.torn_here;
  if (answered_) return "this process still lacks " + collector_.Missing(rig_);
  const auto found = statuses_.find(wanted);
  if (step().kind == SessionStep::Kind::kNextPose) {
    return "nobody said that the board stands; where you carry it: rgbdt-session --by-hand";
  }
  if (wanted.empty()) {
    return "is rgbdt-motor, rgbdt-lidar (or rgbdt-simulator) running, whichever turns or sweeps?";
  }
  if (found == statuses_.end()) return "rgbdt-" + wanted + " was not heard; is it running?";
  const Utime silence = now_ - heard_.at(wanted);
  const bool silent = silence > kSilence;
  return "rgbdt-" + wanted +
         (silent ? " has not been heard for " + std::to_string(silence / kMicrosecondsPerSecond) +
                       " s, is it running, or at work? It said: "
                 : " says: ") +
         found->second.text +
         (found->second.last_problem.empty() ? ""
                                             : "; last problem: " + found->second.last_problem);
}

}  // namespace rgbdt
