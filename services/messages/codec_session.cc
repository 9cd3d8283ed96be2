#include "services/messages/check.h"
#include "services/messages/internal/codec_types.h"
#include "services/messages/internal/fields.h"

namespace rgbdt {

// The rig has no time of its own: its utime is 0.
template <typename Copy>
void Fields(const Copy& copy, WireOf<Copy, rig_t>& wire, StructOf<Copy, RigText>& rig) {
  copy(wire.seq, rig.seq);
  copy(wire.hash, rig.hash);
  copy(wire.text, rig.text);
}

rig_t ToWire(const RigText& rig) { return FieldsToWire<rig_t>(rig); }

void Check(const rig_t& wire) {
  CheckUtimeOrZero("utime", wire.utime);
  CheckName("hash", wire.hash, true);
  CheckText("text", wire.text, kMaxMessageBytes);
}

RigText FromWire(const rig_t& wire) { return FieldsFromWire<RigText>(wire); }

template <typename Copy>
void Fields(const Copy& copy, WireOf<Copy, session_command_t>& wire,
            StructOf<Copy, SessionCommand>& command) {
  copy(wire.utime, command.utime);
  copy(wire.seq, command.seq);
  copy(wire.command, command.command);
  copy(wire.verb, command.verb);
  copy(wire.view, command.view);
  copy(wire.sweep_utime, command.sweep_utime);
  copy(wire.heldout, command.heldout);
  copy.List("num_picked", wire.num_picked, wire.picked_camera, command.picked_cameras);
}

session_command_t ToWire(const SessionCommand& command) {
  return FieldsToWire<session_command_t>(command);
}

void Check(const session_command_t& wire) {
  CheckUtimeOrZero("utime", wire.utime);
  CheckRange("command", wire.command, 0, kMaxInteger);
  CheckRange("verb", wire.verb, session_command_t::NEXT_POSE, session_command_t::SAY_VIEW);
  CheckName("view", wire.view, true);
  CheckUtimeOrZero("sweep_utime", wire.sweep_utime);
  CheckRange("num_picked", wire.num_picked, 0, kMaxCameras);
  for (std::size_t i = 0; i < wire.picked_camera.size(); ++i) {
    CheckCameraName(At("picked_camera", i), wire.picked_camera[i]);
  }
}

SessionCommand FromWire(const session_command_t& wire) {
  return FieldsFromWire<SessionCommand>(wire);
}

template <typename Copy>
void Fields(const Copy& copy, WireOf<Copy, session_event_t>& wire,
            StructOf<Copy, SessionEvent>& event) {
  copy(wire.utime, event.utime);
  copy(wire.seq, event.seq);
  copy(wire.command, event.command);
  copy(wire.source, event.source);
  copy(wire.kind, event.kind);
  copy(wire.text, event.text);
  copy(wire.sweep_utime, event.sweep_utime);
  copy(wire.fraction, event.fraction);
}

session_event_t ToWire(const SessionEvent& event) { return FieldsToWire<session_event_t>(event); }

void Check(const session_event_t& wire) {
  CheckUtimeOrZero("utime", wire.utime);
  CheckRange("command", wire.command, 0, kMaxInteger);
  CheckName("source", wire.source);
  CheckRange("kind", wire.kind, session_event_t::PROGRESS, session_event_t::FAILED);
  CheckText("text", wire.text);
  CheckUtimeOrZero("sweep_utime", wire.sweep_utime);
  if (!(wire.fraction >= 0 && wire.fraction <= 1)) Fail("fraction", wire.fraction, "0 to 1");
}

SessionEvent FromWire(const session_event_t& wire) { return FieldsFromWire<SessionEvent>(wire); }

template <typename Copy>
void Fields(const Copy& copy, WireOf<Copy, session_request_t>& wire,
            StructOf<Copy, SessionRequest>& request) {
  copy(wire.utime, request.utime);
  copy(wire.seq, request.seq);
  copy(wire.request, request.request);
  copy(wire.heldout, request.heldout);
}

session_request_t ToWire(const SessionRequest& request) {
  return FieldsToWire<session_request_t>(request);
}

void Check(const session_request_t& wire) {
  CheckUtimeOrZero("utime", wire.utime);
  CheckRange("request", wire.request, session_request_t::NEXT_POSE, session_request_t::FINISH);
}

SessionRequest FromWire(const session_request_t& wire) {
  return FieldsFromWire<SessionRequest>(wire);
}

template <typename Copy>
void Fields(const Copy& copy, WireOf<Copy, left_out_views_t>& wire,
            StructOf<Copy, LeftOutViews>& left_out) {
  copy(wire.utime, left_out.utime);
  copy(wire.seq, left_out.seq);
  copy.List("num_left_out", wire.num_left_out, wire.left_out, left_out.views);
}

left_out_views_t ToWire(const LeftOutViews& left_out) {
  return FieldsToWire<left_out_views_t>(left_out);
}

void Check(const left_out_views_t& wire) {
  constexpr int kMostViews = 1000;
  CheckUtimeOrZero("utime", wire.utime);
  CheckRange("num_left_out", wire.num_left_out, 0, kMostViews);
  for (std::size_t i = 0; i < wire.left_out.size(); ++i) {
    CheckName(At("left_out", i), wire.left_out[i]);
  }
}

LeftOutViews FromWire(const left_out_views_t& wire) { return FieldsFromWire<LeftOutViews>(wire); }

// All but the counters.
template <typename Copy>
void Fields(const Copy& copy, WireOf<Copy, status_t>& wire, StructOf<Copy, Status>& status) {
  copy(wire.utime, status.utime);
  copy(wire.seq, status.seq);
  copy(wire.process, status.process);
  copy(wire.ready, status.ready);
  copy(wire.text, status.text);
  copy(wire.last_problem, status.last_problem);
}

status_t ToWire(const Status& status) {
  auto wire = FieldsToWire<status_t>(status);
  wire.num_counters = CountOf(status.counters.size(), "num_counters");
  for (const auto& [name, value] : status.counters) {
    wire.counter_name.push_back(name);
    wire.counter_value.push_back(value);
  }
  return wire;
}

void Check(const status_t& wire) {
  CheckUtimeOrZero("utime", wire.utime);
  CheckName("process", wire.process);
  CheckText("text", wire.text);
  CheckText("last_problem", wire.last_problem);
  CheckRange("num_counters", wire.num_counters, 0, kMaxCounters);
  for (std::size_t i = 0; i < wire.counter_name.size(); ++i) {
    CheckText(At("counter_name", i), wire.counter_name[i], kMaxNameBytes);
    CheckRange(At("counter_value", i), wire.counter_value[i], -kMaxInteger, kMaxInteger);
  }
}

Status FromWire(const status_t& wire) {
  auto status = FieldsFromWire<Status>(wire);
  for (std::size_t i = 0; i < wire.counter_name.size(); ++i) {
    status.counters.emplace_back(wire.counter_name[i], wire.counter_value[i]);
  }
  return status;
}

template <typename Copy>
void Fields(const Copy& copy, WireOf<Copy, report_t>& wire, StructOf<Copy, ReportText>& report) {
  copy(wire.utime, report.utime);
  copy(wire.seq, report.seq);
  copy(wire.json, report.json);
}

report_t ToWire(const ReportText& report) { return FieldsToWire<report_t>(report); }

void Check(const report_t& wire) {
  CheckUtimeOrZero("utime", wire.utime);
  CheckText("json", wire.json, kMaxMessageBytes);
}

ReportText FromWire(const report_t& wire) { return FieldsFromWire<ReportText>(wire); }

}  // namespace rgbdt
