#include "services/nodes/session_node.h"

#include <algorithm>
#include <cstdio>
#include <iterator>

#include "calib/camera/pixels.h"
#include "calib/files/schema/calibration_file.h"
#include "calib/files/schema/report_file.h"
#include "calib/files/session/session_dir.h"
#include "calib/model/errors.h"
#include "calib/present/report/verdict.h"
#include "services/nodes/internal/session_steps.h"

namespace rgbdt {
namespace {

constexpr Utime kStartTimeout = 30 * kMicrosecondsPerSecond;  // until everybody is ready
const char* const kAllIsOnDisk = "rgbdt calibrate DIR takes all views that are on disk";
constexpr double kPatience = 1e9;  // s, with a person who carries the board

std::string ViewName(int number) {
  char name[16];
  std::snprintf(name, sizeof(name), "%04d", number);
  return name;
}

// Two sessions' views must not mix.
void RequireNoViews(const std::filesystem::path& directory) {
  std::error_code ignored;
  const std::filesystem::path views = directory / "views";
  if (std::filesystem::exists(views, ignored) && !std::filesystem::is_empty(views, ignored)) {
    throw InputError(views.string() +
                     " holds views of an earlier session; remove them or name another directory");
  }
}

}  // namespace

SessionNode::SessionNode(SessionScript script, Rig rig, std::filesystem::path directory,
                         OnProgress progress, BoardStands board_stands)
    : script_(std::move(script)),
      rig_(std::move(rig)),
      directory_(std::move(directory)),
      progress_(std::move(progress)),
      board_stands_(std::move(board_stands)) {
  if (script_.steps.empty()) throw InputError("the session script has no steps");
  RequireNoViews(directory_);
  for (SessionStep& step : script_.steps) {
    if (board_stands_ && step.kind == SessionStep::Kind::kNextPose) step.timeout_s = kPatience;
  }
}

SessionNode::SessionNode(Rig rig, std::filesystem::path directory, OnProgress progress)
    : by_request_(true),
      rig_(std::move(rig)),
      directory_(std::move(directory)),
      progress_(std::move(progress)) {
  RequireNoViews(directory_);
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
    if (status->process == "solver" && solver_views_.LostBy(*status)) {
      RestoreSolver("rgbdt-solver was started anew and has lost its views");
    }
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
    if (IsCaptured(detection->view)) solver_views_.Add(*detection);
  } else if (const auto* left_out = std::get_if<LeftOutViews>(&message)) {
    if (started_) solver_views_.Set(*left_out);
  } else if (const auto* report = std::get_if<ReportText>(&message)) {
    report_ = ReportFromJson(report->json, "REPORT message");
  }
}

void SessionNode::OnRequest(const SessionRequest& request) {
  if (request.request == SessionRequestKind::kPoseIsSet) {
    PoseIsSet();
    return;
  }
  if (!by_request_) throw InputError("a script leads this session; what is asked for is not done");
  if (!started_) throw InputError("the session waits for: " + WhoIsNotReady());
  if (!idle()) throw InputError("the session is busy; ask again when it is done");
  failure_.clear();
  switch (request.request) {
    case SessionRequestKind::kNextPose:
      Append(SessionStep::Kind::kNextPose);
      break;
    case SessionRequestKind::kCapture:
      Append(SessionStep::Kind::kSweep);
      Append(SessionStep::Kind::kCapture, request.heldout);
      Append(SessionStep::Kind::kSolve);
      Append(SessionStep::Kind::kEvaluate);
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

// Corners for a view that is on disk: it is written once more, with them.
void SessionNode::OnPicks(const CornerSelection& picks) {
  const auto found = images_.find({picks.camera, picks.image_utime});
  if (found == images_.end()) return;
  View view = ReadView({directory_, rig_, {found->second}}, found->second);
  auto& all = view.picks;
  all.erase(std::remove_if(all.begin(), all.end(),
                           [&](const CornerSelection& p) { return p.camera == picks.camera; }),
            all.end());
  all.push_back(picks);
  WriteView(directory_, view);
}

void SessionNode::OnEvent(const SessionEvent& event) {
  if (event.source == name()) return;
  const auto capture = captures_.find(event.command);
  if (event.source == "detector" && capture != captures_.end() && event.command != command_) {
    PublishEvent(event.kind, "view " + capture->second + ", once more: " + event.text, 1);
    if (!by_request_ || finished_ || event.kind != EventKind::kDone) return;
    Append(SessionStep::Kind::kSolve);
    Append(SessionStep::Kind::kEvaluate);
    return;
  }
  if (!waiting_ || event.command != command_) return;
  if (event.kind == EventKind::kFailed) {
    const std::string why = event.source + ": " + event.text;
    if (event.source == "solver" && RestoreSolver("rgbdt-" + why)) return;
    Fail(why);
    return;
  }
  if (event.kind == EventKind::kProgress) {
    ReportProgress(event.text, event.fraction);
    return;
  }
  const std::string wanted = AnsweredBy(step().kind);
  if (!wanted.empty() && event.source != wanted) return;
  answered_ = true;
  last_answer_ = event.text;
  if (event.sweep_utime != 0) sweep_utime_ = event.sweep_utime;
  ReportProgress(event.text, 1);
}

void SessionNode::SaveView() {
  if (finished_ || !collector_.active()) return;
  const auto view = collector_.Take(rig_);
  if (!view) return;
  try {
    WriteView(directory_, *view);
    view_saved_ = true;
    for (const Image& image : view->images) images_[{image.camera, image.utime}] = view->name;
  } catch (const std::exception& e) {
    Fail(e.what());
  }
}

Messages SessionNode::Advance(Utime now) {
  now_ = now;
  if (!began_) began_ = now;
  Messages out, next;
  if (rig_repeat_.IsDue(now)) out.push_back(RigText{0, rig_.hash, rig_.text});
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
    const bool waits = step().kind == SessionStep::Kind::kWait;
    if (!waits && ToSeconds(now_ - step_began_) > step().timeout_s) {
      Fail("no answer in " + std::to_string(static_cast<int>(step().timeout_s)) + " s; " +
           WhatIsMissing());
    }
    return {};
  }
  if (!finished_) EndStep();
  if (finished_ || idle()) return {};
  return Begin();
}

Messages SessionNode::Start() {
  const std::string who = WhoIsNotReady();
  if (!who.empty()) {
    if (!by_request_ && now_ - *began_ > kStartTimeout) Fail("not ready after 30 s: " + who);
    return {};
  }
  SetEarlierResultsAside();
  WriteRig(directory_, rig_);
  started_ = true;
  solver_views_.Clear();
  Messages out = Send(SessionVerb::kReset);
  if (by_request_) {
    PublishEvent(EventKind::kDone, "ready", 1);
    return out;
  }
  for (Message& message : Begin()) out.push_back(std::move(message));
  return out;
}

void SessionNode::EndStep() {
  waiting_ = false;
  const bool saved = step().kind == SessionStep::Kind::kSave;
  if (step().kind == SessionStep::Kind::kCapture) {
    view_taken_ = true;
    solver_views_.Require(view_);
  }
  if (++index_ < script_.steps.size()) return;
  finished_ = !by_request_ || saved;
  PublishEvent(EventKind::kDone, saved ? "saved to " + directory_.string() : last_answer_, 1);
}

Messages SessionNode::Begin() {
  waiting_ = true;
  answered_ = false;
  step_began_ = now_;
  switch (step().kind) {
    case SessionStep::Kind::kNextPose:
      view_ = ViewName(++view_number_);
      view_taken_ = false;
      Announce("asked for the next pose of the board");
      return Send(SessionVerb::kNextPose);
    case SessionStep::Kind::kSweep:
      if (view_.empty() || view_taken_) view_ = ViewName(++view_number_);
      view_taken_ = false;
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

Messages SessionNode::BeginCapture() {
  view_saved_ = false;
  Announce("looking for the board");
  Messages out = Send(SessionVerb::kCapture);
  captures_[command_] = view_;
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
  newest_command_ = command;
  return {command};
}

bool SessionNode::StepDone() {
  switch (step().kind) {
    case SessionStep::Kind::kWait:
      return ToSeconds(now_ - step_began_) >= step().wait_s;
    case SessionStep::Kind::kSave:
      return true;
    case SessionStep::Kind::kCapture:
      return answered_ && view_saved_;
    case SessionStep::Kind::kSolve:
    case SessionStep::Kind::kEvaluate:
      return answered_ && SolverTookAll();
    default:
      return answered_;
  }
}

// One that was started anew answers from what it has heard since.
bool SessionNode::SolverTookAll() {
  const std::string missing = solver_views_.MissingIn(report_);
  if (missing.empty()) return true;
  const std::string why = "rgbdt-solver's report lacks view " + missing;
  if (!RestoreSolver(why)) Fail(why + "; " + kAllIsOnDisk);
  return false;
}

// False: nothing to give it, or it was of no use.
bool SessionNode::RestoreSolver(const std::string& why) {
  Messages again = solver_views_.Again();
  if (again.empty()) return false;
  if (waiting_ && AnsweredBy(step().kind) == "solver") {
    answered_ = false;
    step_began_ = now_;
    again.emplace_back(newest_command_);
  }
  again_ = std::move(again);
  Warn(why + "; all views are sent to it again");
  return true;
}

// So that what an earlier run found is not taken for this session's.
void SessionNode::SetEarlierResultsAside() {
  const std::string kept = SetResultsAside(directory_);
  if (!kept.empty()) Warn(kept);
}

void SessionNode::Save() {
  if (!report_) {
    Fail("nothing to save: no report came from the solver; put solve before save in the script");
    return;
  }
  const std::string missing = solver_views_.MissingIn(report_);
  if (!missing.empty()) {
    Fail("the newest report lacks view " + missing + "; put solve after the last capture; " +
         kAllIsOnDisk);
    return;
  }
  const Calibration calibration = JudgedCalibration(*report_, rig_);
  if (calibration.cameras.empty()) {
    SetEarlierResultsAside();
  } else {
    WriteCalibration(directory_ / "calibration.textproto", calibration);
  }
  WriteReport(directory_ / "report.json", WithVerdicts(*report_));
  for (const CameraReport& camera : report_->cameras) {
    if (camera.calibration.solved()) continue;
    Fail("camera " + camera.calibration.camera + ": " + camera.calibration.StatusText());
    return;
  }
  ReportProgress("saved to " + directory_.string(), 1);
}

void SessionNode::Fail(const std::string& why) {
  const bool leads = by_request_ && started_;
  const std::string which = leads ? ""
                                  : "step " + std::to_string(index_ + 1) + " of " +
                                        std::to_string(script_.steps.size()) + ", ";
  failure_ = which + (index_ < script_.steps.size() && started_ ? NameOf(step().kind) : "start") +
             (view_.empty() ? "" : ", view " + view_) + ": " + why;
  PublishEvent(EventKind::kFailed, failure_, 1);
  finished_ = !leads;
  if (!leads) return;
  // What was to follow is dropped; the person decides.
  index_ = script_.steps.size();
  waiting_ = false;
  view_taken_ = true;
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

bool SessionNode::IsCaptured(const std::string& view) const {
  return std::any_of(captures_.begin(), captures_.end(),
                     [&](const auto& capture) { return capture.second == view; });
}

bool SessionNode::WaitsForPose() const {
  return waiting_ && !answered_ && step().kind == SessionStep::Kind::kNextPose;
}

void SessionNode::PoseIsSet() {
  if (WaitsForPose()) answered_ = true;
}

void SessionNode::AskWhetherBoardStands() {
  if (board_stands_ && WaitsForPose() && board_stands_()) PoseIsSet();
}

// Processes without which a session leads nowhere.
std::vector<std::string> SessionNode::Needed() const {
  std::vector<std::string> needed = {"assembler", "detector", "solver", "fuser"};
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
  status.text = finished_   ? (failure_.empty() ? "finished" : "failed: " + failure_)
                : !started_ ? "waits for: " + WhoIsNotReady()
                : idle()    ? "waits for a person to ask for something (SESSION_REQUEST)"
                            : "step " + std::to_string(index_ + 1) + " of " +
                               std::to_string(script_.steps.size());
  return status;
}

}  // namespace rgbdt
