#include <algorithm>
#include <array>
#include <string_view>

#include "calib/model/text.h"
#include "services/doctor/checks.h"
#include "services/messages/check.h"
#include "services/messages/status_counters.h"

namespace rgbdt {
namespace {

constexpr std::size_t kMostText = 300;
// A program that was started anew meanwhile falls back once.
constexpr int kTwoSpeakers = 2;

// Counters of a STATUS that tell what was lost or refused, by how they begin: "gaps CLOUD".
constexpr std::array<std::string_view, 5> kLosses{"dropped ", "gaps ", "malformed", "unsigned",
                                                  "messages given up"};

// "gaps CLOUD 12, dropped RIG 1": by how much they grew from one STATUS to another.
std::string Grown(const Status& first, const Status& last) {
  std::string text;
  for (const auto& [name, value] : last.counters) {
    const bool is_loss = std::any_of(
        kLosses.begin(), kLosses.end(),
        [&, &counter = name](std::string_view begin) { return counter.rfind(begin, 0) == 0; });
    const std::int64_t grown = value - CounterOf(first, name);
    if (is_loss && grown > 0)
      text += (text.empty() ? "" : ", ") + name + " " + std::to_string(grown);
  }
  return text;
}

std::string Seconds(double seconds) { return Format("%g s", seconds); }

Finding CheckProcess(const ProcessFacts& process, double seconds) {
  const Status& status = process.last;
  const std::string check = "process " + Printable(status.process, 100);
  const std::string text = Printable(status.text, kMostText);
  const std::string problem =
      status.last_problem.empty()
          ? ""
          : "; its newest problem: " + Printable(status.last_problem, kMostText);
  if (process.fell_back >= kTwoSpeakers) {
    return Problem(
        check, "two programs of this name are on the bus, or one that dies again and again",
        "pgrep -af rgbdt  # on each machine; end one of them, or give it a bus of its own");
  }
  const std::string lost = Grown(process.first, status);
  if (!lost.empty()) {
    return Warning(
        check, "within " + Seconds(seconds) + ": " + lost + problem,
        "uptime  # is its machine too busy? Then \"receive buffer\" and \"network\" here");
  }
  if (!status.ready) return Warning(check, (text.empty() ? "not ready" : text) + problem);
  return Ok(check, text + problem);
}

Findings CheckSilent(const BusFacts& facts, const std::vector<std::string>& expected) {
  std::string silent;
  for (const std::string& name : expected) {
    if (!facts.Speaks(name)) silent += (silent.empty() ? "" : ", ") + name;
  }
  if (silent.empty()) return {};
  return {
      Warning("silent processes",
              "the rig's " + silent + " said nothing for " + Seconds(facts.seconds) +
                  ": gone, not started, or at work",
              "pgrep -af rgbdt  # on each machine; start what is missing: rgbdt-NAME, or, where "
              "none runs, rgbdt up RIG")};
}

}  // namespace

Findings CheckProcesses(const BusFacts& facts, const std::vector<std::string>& expected) {
  Findings findings;
  if (facts.processes.empty()) {
    findings.push_back(
        Ok("processes", "none speaks on the bus (listened for " + Seconds(facts.seconds) + ")"));
  } else {
    for (const ProcessFacts& process : facts.processes) {
      findings.push_back(CheckProcess(process, facts.seconds));
    }
    Append(CheckSilent(facts, expected), &findings);
  }
  for (const std::string& clock : ClockProblems(facts.links.clocks)) {
    findings.push_back(Warning("clocks", clock));
  }
  if (facts.links.datagrams_lost > 0) {
    findings.push_back(Warning(
        "link", "datagrams are lost, most of host " + Printable(facts.links.worst, kMostText),
        "ip -s link  # on both machines: errors, dropped; then cable, switch, or a slower rate"));
  }
  if (facts.malformed.count > 0) {
    findings.push_back(Warning("strangers",
                               std::to_string(facts.malformed.count) +
                                   " datagrams were none of LCM's, the newest from " +
                                   Printable(facts.malformed.newest, kMostText),
                               "another port in LCM_DEFAULT_URL, on all machines of the rig"));
  }
  return findings;
}

}  // namespace rgbdt
