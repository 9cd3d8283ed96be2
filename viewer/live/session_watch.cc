#include "viewer/live/session_watch.h"

#include <tuple>

namespace rgbdt::viewer {
namespace {

constexpr std::size_t kMaxLog = 50;
constexpr std::size_t kMaxProcesses = 100;

std::int64_t CounterOf(const Status& status, const std::string& name) {
  for (const auto& [counter, value] : status.counters) {
    if (counter == name) return value;
  }
  return 0;
}

}  // namespace

void SessionWatch::Add(const Status& status, double now_s) {
  if (processes_.size() >= kMaxProcesses && processes_.count(status.process) == 0) return;
  processes_[status.process] = {status, now_s};
}

void SessionWatch::Add(const SessionEvent& event, SessionState* state) {
  const bool of_session = event.source == "session";
  state->fraction = event.fraction;
  if (event.kind == EventKind::kProgress) {
    if (of_session) doing_ = event.text;
    state->busy = of_session || doing_.empty() ? event.text : doing_ + ": " + event.text;
    if (!of_session) return;  // many, and each replaces the one before
    state->failure.clear();
  } else if (of_session) {
    doing_.clear();
    state->busy.clear();
    if (event.kind == EventKind::kFailed) state->failure = event.text;
  }
  state->log.push_back(event);
  if (state->log.size() > kMaxLog) state->log.erase(state->log.begin());
}

bool SessionWatch::Running(const std::string& process, double now_s) const {
  const auto found = processes_.find(process);
  return found != processes_.end() && now_s - found->second.received_s < kGone;
}

bool SessionWatch::Update(double now_s, SessionState* state) const {
  const auto all = [&] {
    return std::make_tuple(state->mode, state->can, state->step, state->steps, state->busy);
  };
  const auto before = all();
  state->mode = "none";
  state->can.clear();
  if (!Running("session", now_s)) {
    state->busy.clear();
    return all() != before;
  }
  const Status& session = processes_.at("session").status;
  const bool by_request = CounterOf(session, "by request") != 0;
  state->mode = by_request ? "by_hand" : "script";
  state->step = static_cast<int>(CounterOf(session, "step"));
  state->steps = static_cast<int>(CounterOf(session, "steps"));
  if (by_request && state->busy.empty() && CounterOf(session, "busy") == 0) {
    if (Running("simulator", now_s)) state->can.emplace_back("next_pose");
    state->can.emplace_back("capture");
    if (!state->views.empty()) state->can.emplace_back("finish");
  }
  if (CounterOf(session, "waits for pose") != 0) state->can.emplace_back("pose_is_set");
  return all() != before;
}

nlohmann::json SessionWatch::Processes(double now_s) const {
  nlohmann::json all = nlohmann::json::array();
  for (const auto& [name, process] : processes_) {
    nlohmann::json counters = nlohmann::json::array();
    for (const auto& [counter, value] : process.status.counters) {
      counters.push_back({{"name", counter}, {"value", value}});
    }
    all.push_back({{"process", name},
                   {"ready", process.status.ready},
                   {"text", process.status.text},
                   {"last_problem", process.status.last_problem},
                   {"age_s", now_s - process.received_s},
                   {"counters", counters}});
  }
  return all;
}

}  // namespace rgbdt::viewer
