#include "services/runtime/process.h"

#include <malloc.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>

namespace rgbdt {
namespace {

constexpr double kRepeatSeconds = 5;
constexpr std::size_t kMaxEntries =
    1000;  // problems carry values: forget them all rather than grow
constexpr int kWaitMs = 50;
constexpr int kWaitWithIdleMs = 2;  // `idle` paces what it publishes by being called often

volatile std::sig_atomic_t stop_requested = 0;

void OnSignal(int) { stop_requested = 1; }

void CatchSignals() {
  stop_requested = 0;
  struct sigaction action {};
  action.sa_handler = OnSignal;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

// A message takes megabytes for a moment. By default malloc gives them back to the system and asks
// anew for the next one, and the pages' first touch costs more than all coding of a cloud.
void KeepMemoryForTheNextMessage() {
  constexpr int kKeptBytes = 64 * 1024 * 1024;
  mallopt(M_MMAP_THRESHOLD, kKeptBytes / 2);
  mallopt(M_TRIM_THRESHOLD, kKeptBytes);
}

double Now() {
  using Seconds = std::chrono::duration<double>;
  return std::chrono::duration_cast<Seconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

void SayGoodbye(const Status& status) {
  std::string counters;
  for (const auto& [name, value] : status.counters) {
    counters += ", " + name + " " + std::to_string(value);
  }
  spdlog::info("{}: stopped; {}{}", status.process, status.text, counters);
}

void Loop(Node& node, const std::string& url, const Idle& idle, const Bus::Handler& overhear) {
  LcmBus bus(url);
  if (overhear) bus.Subscribe(".*", overhear);
  NodeRunner runner(&node, &bus);
  ProblemLog problems([&](const std::string& line) { spdlog::warn("{}: {}", node.name(), line); });
  runner.SetProblemHandler([&](const std::string& problem) { problems.Add(problem, Now()); });
  double next_tick_s = Now();
  while (stop_requested == 0 && !bus.ended()) {
    if (Now() >= next_tick_s) {
      runner.Tick();
      next_tick_s = std::max(next_tick_s + 1, Now());  // late after a long computation: no burst
    }
    if (idle && !idle(runner)) break;
    bus.Run(idle ? kWaitWithIdleMs : kWaitMs);
  }
  SayGoodbye(runner.GetStatus());
}

}  // namespace

int RunOnLcm(Node& node, const std::string& url, const Idle& idle, const Bus::Handler& overhear) {
  CatchSignals();
  KeepMemoryForTheNextMessage();
  try {
    const std::string advice = ReceiveBufferAdvice();
    if (!advice.empty()) spdlog::warn("{}: {}", node.name(), advice);
    Loop(node, url, idle, overhear);
    return 0;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "rgbdt-%s: %s\n", node.name().c_str(), e.what());
  }
  return 1;
}

int RunDevice(DeviceNode& node, const std::string& url) {
  return RunOnLcm(node, url, [&](NodeRunner& runner) {
    DeviceNews news = node.TakeNews();
    for (const std::string& problem : news.problems) runner.NameProblem(problem);
    runner.Publish(std::move(news.messages));
    return !node.ended();
  });
}

void ProblemLog::Add(const std::string& problem, double now_s) {
  if (entries_.size() >= kMaxEntries && entries_.count(problem) == 0) entries_.clear();
  const auto [entry, is_new] = entries_.try_emplace(problem, Entry{now_s, 0});
  Entry& e = entry->second;
  if (!is_new && now_s - e.said_s < kRepeatSeconds) {
    ++e.unsaid;
    return;
  }
  say_(e.unsaid == 0 ? problem
                     : problem + " (and " + std::to_string(e.unsaid) + " times more since)");
  e = {now_s, 0};
}

}  // namespace rgbdt
