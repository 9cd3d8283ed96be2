#include "services/runtime/process.h"

#include <malloc.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "services/bus/bus_key.h"
#include "services/bus/signed_bus.h"
#include "services/posix/clock.h"
#include "services/runtime/node_runner.h"

namespace rgbdt {
namespace {

constexpr Utime kPause = kMicrosecondsPerSecond;  // between two lines of one source
constexpr Utime kRepeat = 5 * kPause;             // of the same line
constexpr std::size_t kMaxSources = 50;           // strangers make up channels
constexpr std::size_t kMaxKinds = 8;              // and texts

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

std::string WithoutNumbers(std::string text) {
  const auto is_of_number = [](char c) {
    return (c >= '0' && c <= '9') || c == '-' || c == '+' || c == '.';
  };
  text.erase(std::remove_if(text.begin(), text.end(), is_of_number), text.end());
  return text;
}

std::string SourceOf(const std::string& problem) {
  return WithoutNumbers(problem.substr(0, problem.find(':')));
}

void LogGoodbye(const Status& status) {
  std::string counters;
  for (const auto& [name, value] : status.counters) {
    counters += ", " + name + " " + std::to_string(value);
  }
  spdlog::info("{}: stopped; {}{}", status.process, status.text, counters);
}

std::unique_ptr<SignedBus> WithKey(Bus* bus, const std::string& given) {
  const std::filesystem::path file = BusKeyFile(given);
  return file.empty() ? nullptr : std::make_unique<SignedBus>(bus, ReadBusKey(file), HostUtime);
}

void Loop(Node& node, const BusFlags& flags, const Bus::Handler& overhear) {
  LcmBus bus(flags.url);
  if (node.WantsNewest()) bus.WantNewest();
  const std::unique_ptr<SignedBus> signed_bus = WithKey(&bus, flags.key);
  if (overhear) bus.Subscribe(".*", overhear);
  NodeRunner runner(&node, signed_bus ? static_cast<Bus*>(signed_bus.get()) : &bus);
  ProblemLog problems([&](const std::string& line) { spdlog::warn("{}: {}", node.name(), line); });
  runner.SetProblemHandler(
      [&](const std::string& problem) { problems.Add(problem, SteadyUtime()); });
  while (stop_requested == 0 && !bus.ended()) {
    runner.UseSpareTime(SteadyUtime(), bus.waits());
    runner.Advance(SteadyUtime());
    problems.Advance(SteadyUtime());
    if (node.finished()) break;
    bus.Run(static_cast<int>(node.LongestWait() / 1000));
  }
  LogGoodbye(runner.GetStatus());
}

}  // namespace

int RunOnLcm(Node& node, const BusFlags& flags, const Bus::Handler& overhear) {
  CatchSignals();
  KeepMemoryForTheNextMessage();
  try {
    const std::string advice = ReceiveBufferAdvice();
    if (!advice.empty()) spdlog::warn("{}: {}", node.name(), advice);
    Loop(node, flags, overhear);
    return 0;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "rgbdt-%s: %s\n", node.name().c_str(), e.what());
  }
  return 1;
}

void ProblemLog::Add(const std::string& problem, Utime now) {
  std::string key = SourceOf(problem);
  if (sources_.size() >= kMaxSources && sources_.count(key) == 0) key.clear();
  Source& source = sources_[key];
  const bool first = source.written.empty();
  const std::string kind = WithoutNumbers(problem);
  const auto& kinds = source.kinds;
  const bool is_shared = key.empty();
  if (!is_shared && kinds.size() < kMaxKinds &&
      std::find(kinds.begin(), kinds.end(), kind) == kinds.end()) {
    source.kinds.push_back(kind);
    if (!first) return write_(problem);  // something else: a cable that is out, and back
  }
  if (first || now - source.written_at >= (problem == source.written ? kRepeat : kPause)) {
    WriteOf(&source, problem, source.count, now);
    return;
  }
  source.left_out = problem;
  ++source.count;
}

void ProblemLog::Advance(Utime now) {
  for (auto at = sources_.begin(); at != sources_.end();) {
    Source& source = at->second;
    const bool over = now - source.written_at >= kRepeat;
    if (over && source.count == 0) {
      at = sources_.erase(at);
      continue;
    }
    if (over) WriteOf(&source, source.left_out, source.count - 1, now);
    ++at;
  }
}

void ProblemLog::WriteOf(Source* source, const std::string& problem, std::int64_t more, Utime now) {
  write_(more == 0 ? problem : problem + " (and " + std::to_string(more) + " more since)");
  source->written = problem;
  source->written_at = now;
  source->count = 0;
}

}  // namespace rgbdt
