#include "services/bus/internal/repaired_streams.h"

#include <arpa/inet.h>

#include <algorithm>
#include <array>

#include "services/messages/check.h"
#include "services/messages/limits.h"

namespace rgbdt {
namespace {

constexpr std::size_t kMaxRequestBytes = 1300;  // with its message numbers it fits a datagram

std::string Text(std::uint32_t address) {
  std::array<char, INET_ADDRSTRLEN> text{};
  inet_ntop(AF_INET, &address, text.data(), text.size());
  return text.data();
}

// A stranger's numbers: a sum of them is no more than a message may say.
void AddTo(std::int64_t* sum, std::int64_t lost) { *sum = std::min(*sum + lost, kMaxInteger); }

// One that asks for more fragments than a datagram can name is cut.
std::vector<RepairRequest> InDatagrams(std::uint64_t id, std::vector<MissingParts> parts) {
  std::vector<RepairRequest> requests;
  std::size_t room = 0;
  for (MissingParts& part : parts) {
    const std::size_t bytes = 6 + 2 * part.fragments.size();
    if (requests.empty() || bytes > room) {
      requests.push_back({id, {}});
      room = kMaxRequestBytes;
    }
    room -= std::min(room, bytes);
    requests.back().parts.push_back(std::move(part));
  }
  return requests;
}

}  // namespace

RepairedStreams::Streams::iterator RepairedStreams::Find(const Sender& sender, const Beat& beat,
                                                         Utime now) {
  const auto found = streams_.find(sender);
  if (found != streams_.end()) {
    if (found->second.id == beat.id) return found;
    Forget(found);  // another program on the same port
  }
  if (streams_.size() >= kMaxSenders) {
    Forget(std::min_element(streams_.begin(), streams_.end(), [](const auto& a, const auto& b) {
      return a.second.heard < b.second.heard;
    }));
  }
  return streams_
      .emplace(sender,
               Stream{beat.id, OrderedStream(beat.next, is_wanted_), beat.datagrams, 0, 0, now})
      .first;
}

void RepairedStreams::Forget(Streams::iterator stream) {
  AddTo(&lost_, stream->second.lost);
  given_up_ += stream->second.messages.given_up();
  streams_.erase(stream);
}

void RepairedStreams::ForgetSilent(Utime now) {
  for (auto stream = streams_.begin(); stream != streams_.end();) {
    const auto next = std::next(stream);
    if (now - stream->second.heard > kForgotten) Forget(stream);
    stream = next;
  }
  for (auto machine = machines_.begin(); machine != machines_.end();) {
    const bool silent = now - machine->second.offsets.back().first > kForgotten;
    machine = silent ? machines_.erase(machine) : std::next(machine);
  }
}

void RepairedStreams::OnBeat(const Sender& sender, const Beat& beat, Utime now, Utime wall) {
  Stream& stream = Find(sender, beat, now)->second;
  stream.heard = now;
  stream.messages.OnBeat(beat.oldest, beat.next, now);
  // A duplicate on the network counts as one more that came.
  stream.lost =
      std::clamp(static_cast<std::int64_t>(beat.datagrams - stream.sent_before - stream.came),
                 std::int64_t{0}, kMaxInteger);
  AddOffset(sender, beat, now, wall);
  ForgetSilent(now);
  KeepBounded();
}

void RepairedStreams::AddOffset(const Sender& sender, const Beat& beat, Utime now, Utime wall) {
  if (machines_.size() >= kMaxSenders && machines_.count(sender.first) == 0) return;
  Machine& machine = machines_[sender.first];
  machine.name = Printable(beat.host, 64) + " (" + Text(sender.first) + ")";
  machine.offsets.emplace_back(now, beat.host_utime - wall);
  while (now - machine.offsets.front().first > kClockWindow ||
         machine.offsets.size() > kMaxClockSamples) {
    machine.offsets.pop_front();
  }
}

void RepairedStreams::OnRequest(const RepairRequest& request, Utime now) {
  for (auto& [sender, stream] : streams_) {
    if (stream.id == request.id) stream.messages.OnAskedByOthers(request.parts, now);
  }
}

bool RepairedStreams::Add(const Sender& sender, const Datagram& datagram, Utime now,
                          const char** why) {
  const auto found = streams_.find(sender);
  if (found == streams_.end()) return false;
  ++found->second.came;
  if (!found->second.messages.Takes(datagram.seq)) return false;
  found->second.messages.Add(datagram, now, why);
  KeepBounded();
  return true;
}

void RepairedStreams::AddRepair(const Sender& sender, const Datagram& datagram, Utime now,
                                const char** why) {
  const auto found = streams_.find(sender);
  if (found == streams_.end() || !found->second.messages.Takes(datagram.seq)) return;
  if (found->second.messages.Add(datagram, now, why)) ++repaired_;
  KeepBounded();
}

std::size_t RepairedStreams::bytes_held() const {
  std::size_t held = 0;
  for (const auto& [sender, stream] : streams_) held += stream.messages.bytes_held();
  return held;
}

void RepairedStreams::KeepBounded() {
  for (std::size_t held = bytes_held(); held > kMaxBytesHeld;) {
    OrderedStream& most =
        std::max_element(streams_.begin(), streams_.end(), [](const auto& a, const auto& b) {
          return a.second.messages.bytes_held() < b.second.messages.bytes_held();
        })->second.messages;
    held -= most.bytes_held();
    most.GiveUpOldest();
    held += most.bytes_held();
  }
}

std::vector<WholeMessage> RepairedStreams::Take() {
  std::vector<WholeMessage> messages;
  for (auto& [sender, stream] : streams_) {
    for (WholeMessage& message : stream.messages.Take()) messages.push_back(std::move(message));
  }
  return messages;
}

std::vector<RepairRequest> RepairedStreams::Ask(Utime now) {
  std::vector<RepairRequest> requests;
  for (auto& [sender, stream] : streams_) {
    for (RepairRequest& request : InDatagrams(stream.id, stream.messages.Ask(now))) {
      requests.push_back(std::move(request));
    }
  }
  return requests;
}

std::optional<Utime> RepairedStreams::NextAsk() const {
  std::optional<Utime> next;
  for (const auto& [sender, stream] : streams_) {
    const std::optional<Utime> its = stream.messages.NextAsk();
    if (its && (!next || *its < *next)) next = its;
  }
  return next;
}

LinkReport RepairedStreams::report() const {
  LinkReport report;
  report.datagrams_lost = lost_;
  report.messages_given_up = given_up_;
  report.datagrams_repaired = repaired_;
  std::int64_t most = 0;
  for (const auto& [sender, stream] : streams_) {
    AddTo(&report.datagrams_lost, stream.lost);
    report.messages_given_up += stream.messages.given_up();
    const auto machine = machines_.find(sender.first);
    if (stream.lost > most && machine != machines_.end()) {
      most = stream.lost;
      report.worst = machine->second.name + ": " + std::to_string(stream.lost) + " of " +
                     std::to_string(stream.came + static_cast<std::uint64_t>(stream.lost));
    }
  }
  for (const auto& [address, machine] : machines_) {
    if (machine.offsets.size() < kClockSamples) continue;
    Utime least_path = machine.offsets.front().second;
    for (const auto& [when, offset] : machine.offsets) least_path = std::max(least_path, offset);
    report.clocks.push_back({machine.name, least_path});
  }
  return report;
}

}  // namespace rgbdt
