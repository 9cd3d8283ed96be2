#include "services/up/up_node.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "services/messages/check.h"
#include "services/messages/status_counters.h"

namespace rgbdt {
namespace {

constexpr Utime kSilent = 3 * kMicrosecondsPerSecond;
constexpr std::size_t kMostText = 80;

std::string StateOf(const Supervisor::Child& child, Utime now) {
  if (child.pid != 0) return "runs";
  if (child.done) return "done";
  return "in " +
         std::to_string(std::max<Utime>(0, child.next_start - now) / kMicrosecondsPerSecond) + " s";
}

}  // namespace

UpNode::UpNode(std::vector<Program> programs, Supervisor::Tell tell, Show show, std::string name)
    : supervisor_(std::move(programs), std::move(tell)),
      show_(std::move(show)),
      name_(std::move(name)) {
  for (const Supervisor::Child& child : supervisor_.children()) heard_[child.program.name];
}

Messages UpNode::Handle(const Message& message) {
  const auto* status = std::get_if<Status>(&message);
  if (status == nullptr) return {};
  const auto found = heard_.find(status->process);
  if (found == heard_.end()) return {};  // another machine's
  Heard& heard = found->second;
  const auto came =
      static_cast<double>(CounterOf(*status, "received") - CounterOf(heard.status, "received"));
  const double seconds = ToSeconds(now_ - heard.when);
  heard.rate = came >= 0 && heard.when != 0 && seconds > 0.1 ? came / seconds : 0;
  heard.status = *status;
  heard.when = now_;
  return {};
}

Messages UpNode::Advance(Utime now) {
  now_ = now;
  supervisor_.Advance(now);
  if (show_period_.IsDue(now)) show_(Table());
  return {};
}

std::string UpNode::Table() const {
  char line[400];
  std::snprintf(line, sizeof(line), "%-16s %-7s %8s %8s %8s  %s\n", "process", "", "msg/s", "lost",
                "restarts", "says");
  std::string table = line;
  for (const Supervisor::Child& child : supervisor_.children()) {
    const Heard& heard = heard_.at(child.program.name);
    const bool speaks = child.pid != 0 && heard.when != 0 && now_ - heard.when < kSilent;
    std::string text = speaks ? heard.status.text : child.how_it_ended;
    if (child.pid != 0 && !child.program.speaks) text.clear();  // nothing takes its last words back
    if (text.empty() && child.program.speaks) text = "starts";
    const std::int64_t lost = CounterOf(heard.status, "gaps") + CounterOf(heard.status, "dropped");
    std::snprintf(line, sizeof(line), "%-16s %-7s %8.0f %8lld %8d  %s\n",
                  child.program.name.c_str(), StateOf(child, now_).c_str(),
                  speaks ? heard.rate : 0.0, static_cast<long long>(lost),
                  std::max(0, child.starts - 1), Printable(text, kMostText).c_str());
    table += line;
  }
  return table;
}

Status UpNode::GetStatus() const {
  Status status;
  std::int64_t run = 0, restarts = 0;
  for (const Supervisor::Child& child : supervisor_.children()) {
    run += child.pid != 0 || child.done ? 1 : 0;
    restarts += std::max(0, child.starts - 1);
  }
  const auto all = static_cast<std::int64_t>(supervisor_.children().size());
  status.ready = run == all;
  status.text = std::to_string(run) + " of " + std::to_string(all) + " processes run";
  status.counters = {{"restarts", restarts}};
  return status;
}

}  // namespace rgbdt
