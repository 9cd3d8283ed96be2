#include "services/nodes/solver_node.h"

#include <iomanip>
#include <sstream>

#include "calib/files/schema/report_file.h"
#include "calib/files/schema/rig_file.h"
#include "calib/model/errors.h"

namespace rgbdt {
namespace {

std::string Brief(const Report& report, bool heldout) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(2);
  for (const CameraReport& camera : report.cameras) {
    const TrainHeldout& dt = camera.distance_transform_px;
    const auto& value = heldout ? dt.heldout : dt.train;
    text << (text.tellp() > 0 ? "; " : "") << camera.calibration.camera << ": ";
    if (value) {
      text << *value << (heldout ? " px on held-out views" : " px");
    } else {
      text << (heldout ? "no view held out" : camera.calibration.StatusText());
    }
  }
  return text.str();
}

}  // namespace

SolverNode::SolverNode(CalibrateOptions options) : options_(std::move(options)) {
  options_.Check();
}

Messages SolverNode::Handle(const Message& message) {
  if (const auto* text = std::get_if<RigText>(&message)) {
    if (rig_ && rig_->hash == text->hash) return {};
    rig_ = ParseRig(text->text, "RIG message");
    observations_.clear();  // they belonged to another rig
    report_.reset();
    return {};
  }
  if (!rig_) throw InputError("no rig heard yet; start rgbdt-session, or publish RIG");
  if (const auto* observation = std::get_if<Observation>(&message)) {
    rig_->Camera(observation->camera);
    Observations all = observations_;
    all[{observation->view, observation->camera}] = *observation;
    report_ = Solve(all, false);
    observations_ = std::move(all);
    return Calibrations();
  }
  if (const auto* command = std::get_if<SessionCommand>(&message)) return OnCommand(*command);
  return {};
}

Messages SolverNode::OnCommand(const SessionCommand& command) {
  if (command.verb == SessionVerb::kReset) {
    observations_.clear();
    report_.reset();
    return {};
  }
  const bool evaluate = command.verb == SessionVerb::kEvaluate;
  if (command.verb != SessionVerb::kSolve && !evaluate) return {};
  SessionEvent event;
  event.command = command.command;
  event.source = name();
  event.utime = command.utime;
  if (observations_.empty()) {
    event.kind = EventKind::kFailed;
    event.text = "no observation yet; capture views of the target first";
    return {event};
  }
  report_ = Solve(observations_, true);
  Messages out = Calibrations();
  out.push_back(ReportText{0, report_->utime, ReportToJson(*report_)});
  event.text = Brief(*report_, evaluate);
  out.push_back(std::move(event));
  return out;
}

Report SolverNode::Solve(const Observations& observations, bool for_report) const {
  std::vector<Observation> all;
  for (const auto& [key, observation] : observations) all.push_back(observation);
  CalibrateOptions options = options_;
  options.wide_start &= for_report;
  options.diagnostics &= for_report;
  return Calibrate(*rig_, all, options);
}

Messages SolverNode::Calibrations() const {
  Messages out;
  if (!report_) return out;
  for (const CameraCalibration& camera : report_->ToCalibration().cameras) {
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
                : !report_ ? "waits for observations"
                           : "calibrated from " + std::to_string(observations_.size()) +
                                 " observations: " + Brief(*report_, false);
  status.counters = {{"observations", static_cast<std::int64_t>(observations_.size())}};
  return status;
}

}  // namespace rgbdt
