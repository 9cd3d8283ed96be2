#include <algorithm>
#include <map>
#include <utility>

#include "calib/model/errors.h"
#include "services/bus/sequence.h"
#include "services/doctor/facts.h"
#include "services/messages/codec.h"
#include "services/posix/clock.h"

namespace rgbdt {
namespace {

// Strangers make up names.
constexpr std::size_t kMostProcesses = 200;
constexpr int kWaitMs = 100;

struct Speaker {
  ProcessFacts facts;
  SequenceCounter sequence;
};

}  // namespace

bool BusFacts::Speaks(const std::string& process) const {
  return std::any_of(processes.begin(), processes.end(),
                     [&](const ProcessFacts& one) { return one.last.process == process; });
}

BusFacts GatherBus(const std::string& url, double seconds) {
  std::map<std::string, Speaker> speakers;
  const auto hear = [&](const std::string& channel, const std::uint8_t* data, std::size_t size) {
    try {
      const auto status = std::get<Status>(Decode(channel, data, size));
      if (speakers.size() >= kMostProcesses && speakers.count(status.process) == 0) return;
      auto& [facts, sequence] = speakers[status.process];
      const SequenceCounter::Kind kind = sequence.Add(status.seq).kind;
      facts.fell_back += kind == SequenceCounter::Kind::kRestart ||
                                 kind == SequenceCounter::Kind::kDuplicate ||
                                 kind == SequenceCounter::Kind::kLate
                             ? 1
                             : 0;
      if (facts.heard++ == 0) facts.first = status;
      facts.last = status;
    } catch (const InputError&) {  // what somebody else means by STATUS: its receivers count it
    }
  };
  LcmBus bus(url);
  bus.Subscribe("STATUS", hear);
  const Utime end = SteadyUtime() + FromSeconds(seconds);
  while (SteadyUtime() < end && !bus.ended()) bus.Run(kWaitMs);
  BusFacts facts;
  facts.seconds = seconds;
  for (auto& [name, speaker] : speakers) facts.processes.push_back(std::move(speaker.facts));
  facts.malformed = bus.malformed();
  facts.links = bus.links();
  return facts;
}

}  // namespace rgbdt
