#include "services/bus/link_report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>

namespace rgbdt {
namespace {

constexpr std::size_t kMajority = 3;  // machines, of which two can agree against one

std::string HowFar(Utime ahead) {
  char text[64];
  std::snprintf(text, sizeof text, "%.2f s %s", std::abs(ToSeconds(ahead)),
                ahead > 0 ? "ahead of" : "behind");
  return text;
}

bool IsOff(Utime ahead) { return std::abs(ahead) > kClockTolerance; }

}  // namespace

std::vector<std::string> ClockProblems(const std::vector<ClockOffset>& clocks) {
  std::vector<std::string> problems;
  if (clocks.empty()) return problems;
  Utime right = 0;
  if (clocks.size() >= kMajority) {
    std::vector<Utime> all;
    for (const ClockOffset& clock : clocks) all.push_back(clock.ahead);
    const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
    std::nth_element(all.begin(), middle, all.end());
    right = *middle;
    const auto agree = std::count_if(all.begin(), all.end(),
                                     [right](Utime ahead) { return !IsOff(ahead - right); });
    if (2 * static_cast<std::size_t>(agree) <= all.size()) right = 0;  // no most of them
  }
  const char* whose = clocks.size() >= kMajority ? " the others'" : " this machine's";
  for (const ClockOffset& clock : clocks) {
    if (!IsOff(clock.ahead - right)) continue;
    problems.push_back("the clock of host " + clock.host + " is " + HowFar(clock.ahead - right) +
                       whose + "; on each host: sudo timedatectl set-ntp true");
  }
  return problems;
}

std::int64_t ReassemblyFailures() {
  // Two lines begin with Ip: names, then values.
  std::ifstream file("/proc/net/snmp");
  std::string names, values;
  if (!std::getline(file, names) || !std::getline(file, values)) return 0;
  std::istringstream name_of(names), value_of(values);
  for (std::string name, value; name_of >> name && value_of >> value;) {
    if (name == "ReasmFails") return std::strtoll(value.c_str(), nullptr, 10);
  }
  return 0;
}

}  // namespace rgbdt
