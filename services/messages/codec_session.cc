#include "services/messages/check.h"
#include "services/messages/internal/codec_types.h"

namespace rgbdt {
namespace {

constexpr std::int64_t kMaxCameras = 32;
constexpr std::int64_t kMaxCounters = 1000;

}  // namespace

// The rig has no time of its own.
rig_t ToWire(const RigText& rig) {
  rig_t wire;
  wire.utime = 0;
  wire.seq = rig.seq;
  wire.hash = rig.hash;
  wire.text = rig.text;
  return wire;
}

void Check(const rig_t& wire) {
  CheckUtimeOrZero("utime", wire.utime);
  CheckSeq(wire.seq);
  CheckName("hash", wire.hash, true);
  CheckText("text", wire.text, kMaxMessageBytes);
}

RigText FromWire(const rig_t& wire) {
  RigText rig;
  rig.seq = wire.seq;
  rig.hash = wire.hash;
  rig.text = wire.text;
  return rig;
}

session_command_t ToWire(const SessionCommand& command) {
  session_command_t wire;
  wire.utime = command.utime;
  wire.seq = command.seq;
  wire.command = command.command;
  wire.verb = static_cast<std::int8_t>(command.verb);
  wire.view = command.view;
  wire.sweep_utime = command.sweep_utime;
  wire.heldout = static_cast<std::int8_t>(command.heldout);
  wire.num_picked = CountOf(command.picked_cameras.size(), "num_picked");
  wire.picked_camera = command.picked_cameras;
  return wire;
}

void Check(const session_command_t& wire) {
  CheckUtimeOrZero("utime", wire.utime);
  CheckSeq(wire.seq);
  CheckRange("command", wire.command, 0, kMaxInteger);
  CheckRange("verb", wire.verb, session_command_t::NEXT_POSE, session_command_t::RESET);
  CheckName("view", wire.view, true);
  CheckUtimeOrZero("sweep_utime", wire.sweep_utime);
  CheckRange("num_picked", wire.num_picked, 0, kMaxCameras);
  for (std::size_t i = 0; i < wire.picked_camera.size(); ++i) {
    CheckCameraName(At("picked_camera", i), wire.picked_camera[i]);
  }
}

SessionCommand FromWire(const session_command_t& wire) {
  SessionCommand command;
  command.utime = wire.utime;
  command.seq = wire.seq;
  command.command = wire.command;
  command.verb = static_cast<SessionVerb>(wire.verb);
  command.view = wire.view;
  command.sweep_utime = wire.sweep_utime;
  command.heldout = wire.heldout != 0;
  command.picked_cameras = wire.picked_camera;
  return command;
}

session_event_t ToWire(const SessionEvent& event) {
  session_event_t wire;
  wire.utime = event.utime;
  wire.seq = event.seq;
  wire.command = event.command;
  wire.source = event.source;
  wire.kind = static_cast<std::int8_t>(event.kind);
  wire.text = event.text;
  wire.sweep_utime = event.sweep_utime;
  wire.fraction = event.fraction;
  return wire;
}

void Check(const session_event_t& wire) {
  CheckUtimeOrZero("utime", wire.utime);
  CheckSeq(wire.seq);
  CheckRange("command", wire.command, 0, kMaxInteger);
  CheckName("source", wire.source);
  CheckRange("kind", wire.kind, session_event_t::PROGRESS, session_event_t::FAILED);
  CheckText("text", wire.text);
  CheckUtimeOrZero("sweep_utime", wire.sweep_utime);
  if (!(wire.fraction >= 0 && wire.fraction <= 1)) Fail("fraction", wire.fraction, "0 to 1");
}

SessionEvent FromWire(const session_event_t& wire) {
  SessionEvent event;
  event.utime = wire.utime;
  event.seq = wire.seq;
  event.command = wire.command;
  event.source = wire.source;
  event.kind = static_cast<EventKind>(wire.kind);
  event.text = wire.text;
  event.sweep_utime = wire.sweep_utime;
  event.fraction = wire.fraction;
  return event;
}

session_request_t ToWire(const SessionRequest& request) {
  session_request_t wire;
  wire.utime = request.utime;
  wire.seq = request.seq;
  wire.request = static_cast<std::int8_t>(request.request);
  wire.heldout = static_cast<std::int8_t>(request.heldout);
  return wire;
}

void Check(const session_request_t& wire) {
  CheckUtimeOrZero("utime", wire.utime);
  CheckSeq(wire.seq);
  CheckRange("request", wire.request, session_request_t::NEXT_POSE, session_request_t::FINISH);
}

SessionRequest FromWire(const session_request_t& wire) {
  SessionRequest request;
  request.utime = wire.utime;
  request.seq = wire.seq;
  request.request = static_cast<SessionRequestKind>(wire.request);
  request.heldout = wire.heldout != 0;
  return request;
}

status_t ToWire(const Status& status) {
  status_t wire;
  wire.utime = status.utime;
  wire.seq = status.seq;
  wire.process = status.process;
  wire.ready = static_cast<std::int8_t>(status.ready);
  wire.text = status.text;
  wire.last_problem = status.last_problem;
  wire.num_counters = CountOf(status.counters.size(), "num_counters");
  for (const auto& [name, value] : status.counters) {
    wire.counter_name.push_back(name);
    wire.counter_value.push_back(value);
  }
  return wire;
}

void Check(const status_t& wire) {
  CheckUtimeOrZero("utime", wire.utime);
  CheckSeq(wire.seq);
  CheckName("process", wire.process);
  CheckText("text", wire.text);
  CheckText("last_problem", wire.last_problem);
  CheckRange("num_counters", wire.num_counters, 0, kMaxCounters);
  for (std::size_t i = 0; i < wire.counter_name.size(); ++i) {
    CheckText(At("counter_name", i), wire.counter_name[i], kMaxNameBytes);
  }
}

Status FromWire(const status_t& wire) {
  Status status;
  status.utime = wire.utime;
  status.seq = wire.seq;
  status.process = wire.process;
  status.ready = wire.ready != 0;
  status.text = wire.text;
  status.last_problem = wire.last_problem;
  for (std::size_t i = 0; i < wire.counter_name.size(); ++i) {
    status.counters.emplace_back(wire.counter_name[i], wire.counter_value[i]);
  }
  return status;
}

report_t ToWire(const ReportText& report) {
  report_t wire;
  wire.utime = report.utime;
  wire.seq = report.seq;
  wire.json = report.json;
  return wire;
}

void Check(const report_t& wire) {
  CheckUtimeOrZero("utime", wire.utime);
  CheckSeq(wire.seq);
  CheckText("json", wire.json, kMaxMessageBytes);
}

ReportText FromWire(const report_t& wire) {
  ReportText report;
  report.utime = wire.utime;
  report.seq = wire.seq;
  report.json = wire.json;
  return report;
}

}  // namespace rgbdt
