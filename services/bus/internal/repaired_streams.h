#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "services/bus/internal/ordered_stream.h"
#include "services/bus/internal/reassembly.h"
#include "services/bus/link_report.h"

namespace rgbdt {

/// What a receiver has of all the senders that can repeat what is lost; a sender is known to be one
/// by its Beat. Counts, for each, what was lost on the way here: datagrams that it says it sent
/// less those that came. Tells how far other machines' clocks are off this one's: by a Beat's stamp
/// and when it came, less the smallest path of kClockWindow.
///
/// Bounded: 64 senders; 4096 beats of a machine; 64 MiB of messages that are not whole or wait for
/// such a one, and of numbers of which nothing came; there the oldest of the sender that holds most
/// is given up. A sender silent for
/// kForgotten is forgotten. Times are of any steady clock [us], but `wall`: the machine's [us,
/// UTC].
class RepairedStreams {
 public:
  using Sender = Reassembly::Sender;
  static constexpr Utime kForgotten = 30 * kMicrosecondsPerSecond;
  static constexpr Utime kClockWindow = 5 * kMicrosecondsPerSecond;
  static constexpr std::size_t kClockSamples = 3;        ///< before that nothing is said
  static constexpr std::size_t kMaxClockSamples = 4096;  ///< of a machine; then the oldest go
  static constexpr std::size_t kMaxSenders = 64;
  static constexpr std::size_t kMaxBytesHeld = std::size_t{64} << 20;

  explicit RepairedStreams(OrderedStream::IsWanted is_wanted) : is_wanted_(std::move(is_wanted)) {}

  void OnBeat(const Sender& sender, const Beat& beat, Utime now, Utime wall);
  /// Somebody's, our own, too.
  void OnRequest(const RepairRequest& request, Utime now);
  /// A datagram as it was sent, not on kRepairChannel. False: it belongs to no stream.
  bool Add(const Sender& sender, const Datagram& datagram, Utime now, const char** why);
  /// One that was lost and is repeated.
  void AddRepair(const Sender& sender, const Datagram& datagram, Utime now, const char** why);

  std::vector<WholeMessage> Take();
  /// What to ask for now: requests that each fit a datagram.
  std::vector<RepairRequest> Ask(Utime now);
  std::optional<Utime> NextAsk() const;

  std::size_t bytes_held() const;
  /// Without ip_fragments_given_up.
  LinkReport report() const;

 private:
  struct Machine {
    std::string name;
    std::deque<std::pair<Utime, Utime>> offsets;  // when, and its clock less ours and the path
  };
  struct Stream {
    std::uint64_t id;
    OrderedStream messages;
    std::uint64_t sent_before, came = 0;
    std::int64_t lost = 0;
    Utime heard;
  };
  using Streams = std::map<Sender, Stream>;

  Streams::iterator Find(const Sender& sender, const Beat& beat, Utime now);
  void Forget(Streams::iterator stream);
  void ForgetSilent(Utime now);
  void KeepBounded();
  void AddOffset(const Sender& sender, const Beat& beat, Utime now, Utime wall);

  OrderedStream::IsWanted is_wanted_;
  Streams streams_;
  std::map<std::uint32_t, Machine> machines_;  // by address
  std::int64_t lost_ = 0, given_up_ = 0;       // of those that were forgotten
  std::int64_t repaired_ = 0;
};

}  // namespace rgbdt
