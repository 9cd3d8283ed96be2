#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "calib/files/schema/report_file.h"
#include "calib/files/schema/session_script.h"
#include "tests/nodes/nodes_testing.h"

namespace rgbdt::test {

inline constexpr Utime kStart = 1'500'000'000'000'000;

inline SessionStep Step(SessionStep::Kind kind) {
  SessionStep step;
  step.kind = kind;
  step.timeout_s = 10;
  return step;
}

inline SessionScript Script(const std::vector<SessionStep::Kind>& kinds) {
  SessionScript script;
  for (const SessionStep::Kind kind : kinds) script.steps.push_back(Step(kind));
  return script;
}

inline Status Ready(const std::string& process, const std::string& text = "fine",
                    bool ready = true) {
  Status status;
  status.process = process;
  status.ready = ready;
  status.text = text;
  return status;
}

/// Advances to a time [s]; what the node says besides the rig, which it repeats.
inline Messages AdvanceTo(double seconds, Node* node) {
  Messages out;
  for (Message& message : node->Advance(FromSeconds(seconds))) {
    if (!std::holds_alternative<RigText>(message)) out.push_back(std::move(message));
  }
  return out;
}

inline Image Blank(const CameraSpec& camera, Utime utime) {
  Image image;
  image.camera = camera.name;
  image.utime = utime;
  image.format = camera.format;
  image.pixels = cv::Mat(camera.height, camera.width,
                         camera.kind == CameraKind::kThermal ? CV_16UC1 : CV_8UC1, cv::Scalar(90));
  return image;
}

// Everybody else, in one: answers each command as its verb asks, unless told otherwise.
class World {
 public:
  Messages Answer(const SessionCommand& command) {
    commands.push_back(command);
    if (command.verb == silent_at) return {};
    now += kMicrosecondsPerSecond;
    switch (command.verb) {
      case SessionVerb::kReset:
      case SessionVerb::kGoOn:
      case SessionVerb::kSayView:
        return {};
      case SessionVerb::kNextPose:
        return {Event(command, "simulator")};
      case SessionVerb::kSweep:
        return Sweep(command);
      case SessionVerb::kCapture:
        return Capture(command);
      case SessionVerb::kSolve:
      case SessionVerb::kEvaluate:
        break;
    }
    Report report;
    for (const std::string& view : views) {
      if (view == forgotten) continue;
      report.detections.emplace_back();
      report.detections.back().view = view;
    }
    for (const CameraSpec& camera : TinyRig().cameras) {
      report.cameras.emplace_back();
      report.cameras.back().calibration.camera = camera.name;
      report.cameras.back().calibration.status =
          solved ? SolveStatus::kConverged : SolveStatus::kNotSolved;
      if (!solved) report.cameras.back().calibration.detail = "2 usable views";
      if (solved) report.cameras.back().distance_transform_px.train = 1;
    }
    report.method = "paper";
    report.rig_hash = TinyRig().hash;
    return {ReportText{0, now, ReportToJson(report)}, Event(command, "solver")};
  }

  SessionEvent Event(const SessionCommand& command, const std::string& source) const {
    SessionEvent event;
    event.command = command.command;
    event.source = source;
    event.utime = now;
    event.text = "done by " + source;
    if (command.verb == failing_at) {
      event.kind = EventKind::kFailed;
      event.text = "the motor is stuck";
    }
    return event;
  }

  /// What the detector says of a capture, at first and once there are corners for it.
  Messages Detect(const SessionCommand& capture) const {
    ViewDetection detection;
    detection.view = capture.view;
    detection.sweep_utime = capture.sweep_utime;
    detection.cloud.why_not = "made up";
    return {detection, Event(capture, "detector")};
  }

  Utime now = kStart;
  std::optional<SessionVerb> silent_at, failing_at;
  bool images = true;
  bool solved = true;
  std::string forgotten;  // a view that the solver does not have
  std::vector<SessionCommand> commands;
  std::set<std::string> views;  // that were captured

 private:
  Messages Sweep(const SessionCommand& command) const {
    SessionEvent done = Event(command, "simulator");
    done.sweep_utime = now;
    return {SweepOfTwo(now), done};
  }
  Messages Capture(const SessionCommand& command) {
    Messages out;
    views.insert(command.view);
    for (const CameraSpec& camera : TinyRig().cameras) {
      if (images) out.push_back(Blank(camera, now));
    }
    for (const std::string& camera : command.picked_cameras) {
      CornerSelection picks;
      picks.camera = camera;
      picks.utime = picks.image_utime = now;
      picks.corners = {{{1, 1}, {9, 1}, {9, 9}, {1, 9}}};
      out.push_back(picks);
    }
    out.push_back(Event(command, "simulator"));  // its images are taken: not what is waited for
    for (Message& message : Detect(command)) out.push_back(std::move(message));
    return out;
  }
};

}  // namespace rgbdt::test
