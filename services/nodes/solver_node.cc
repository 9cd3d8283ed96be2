#include "services/nodes/solver_node.h"

#include <utility>

#include "calib/files/schema/report_file.h"
#include "calib/files/schema/rig_file.h"
#include "calib/methods/calibrate_without.h"
#include "calib/model/errors.h"
#include "calib/present/report/summary.h"
#include "calib/present/report/verdict.h"

namespace rgbdt {

SolverNode::SolverNode(CalibrateOptions options) : options_(std::move(options)) {
  options_.Check();
}

Messages SolverNode::Handle(const Message& message) {
  if (const auto* text = std::get_if<RigText>(&message)) {
    if (rig_ && rig_->hash == text->hash) return {};
    rig_ = ParseRig(text->text, "RIG message");
    Forget();  // the views belonged to another rig
    return {};
  }
  if (!rig_) throw InputError("no rig heard yet; start rgbdt-session, or publish RIG");
  if (const auto* detection = std::get_if<ViewDetection>(&message)) {
    for (const ImageDetection& image : detection->images) rig_->Camera(image.camera);
    Detections all = detections_;
    all[detection->view] = *detection;
    report_ = Solve(all, false);
    detections_ = std::move(all);
    return Calibrations();
  }
  if (const auto* command = std::get_if<SessionCommand>(&message)) return OnCommand(*command);
  if (const auto* left_out = std::get_if<LeftOutViews>(&message)) return OnLeftOut(*left_out);
  return {};
}

void SolverNode::Forget() {
  detections_.clear();
  left_out_.clear();
  report_.reset();
}

// Where the rest cannot be solved for, all stays as it was.
Messages SolverNode::OnLeftOut(const LeftOutViews& message) {
  const std::set<std::string> before =
      std::exchange(left_out_, {message.views.begin(), message.views.end()});
  if (detections_.empty()) return {};
  try {
    report_ = Solve(detections_, true);
  } catch (...) {
    left_out_ = before;
    throw;
  }
  Messages out = Calibrations();
  out.push_back(ReportMessage());
  return out;
}

ReportText SolverNode::ReportMessage() const {
  return {0, report_->utime, ReportToJson(WithVerdicts(*report_))};
}

Messages SolverNode::OnCommand(const SessionCommand& command) {
  if (command.verb == SessionVerb::kReset || command.verb == SessionVerb::kGoOn) {
    Forget();
    return {};
  }
  if (command.verb != SessionVerb::kSolve && command.verb != SessionVerb::kEvaluate) return {};
  SessionEvent event;
  event.command = command.command;
  event.source = name();
  event.utime = command.utime;
  if (detections_.empty()) {
    event.kind = EventKind::kFailed;
    event.text = "no view yet; capture views of the target first";
    return {event};
  }
  report_ = Solve(detections_, true);
  Messages out = Calibrations();
  out.push_back(ReportMessage());
  event.text = Summary(*report_).BriefReport();
  out.push_back(std::move(event));
  return out;
}

Report SolverNode::Solve(const Detections& detections, bool for_report) const {
  std::vector<ViewDetection> all;
  for (const auto& [view, detection] : detections) all.push_back(detection);
  CalibrateOptions options = options_;
  options.wide_start &= for_report;
  options.diagnostics &= for_report;
  return CalibrateWithout(*rig_, all, left_out_, options);
}

Messages SolverNode::Calibrations() const {
  Messages out;
  if (!report_) return out;
  for (const CameraCalibration& camera : JudgedCalibration(*report_, *rig_).cameras) {
    out.push_back(
        CalibrationMessage{0, report_->utime, report_->rig_hash, report_->method, camera});
  }
  return out;
}

Messages SolverNode::Advance(Utime now) {
  if (!repeat_.IsDue(now)) return {};
  return Calibrations();
}

Status SolverNode::GetStatus() const {
  Status status;
  status.ready = rig_.has_value();
  status.text = !rig_      ? "waits for the rig (RIG)"
                : !report_ ? "waits for views"
                           : "calibrated from " + std::to_string(detections_.size()) +
                                 " views: " + Summary(*report_).BriefReport();
  status.counters = {{"views", static_cast<std::int64_t>(detections_.size())}};
  return status;
}

}  // namespace rgbdt
