#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "calib/model/time.h"
#include "services/bus/internal/partial_message.h"
#include "services/bus/internal/repair_message.h"

namespace rgbdt {

/// The messages of one sender that can repeat what is lost, in the order in which it sent them. One
/// that is not whole holds up those behind it while it is asked for: what is missing kGrace after
/// the newest of it came, then after pauses that double, kMaxAsked times; then it is given up, some
/// 2.4 s after it was sent. It is given up at once where the sender can no longer repeat it. The
/// messages on channels that nobody wants hold up nothing and are not asked for.
///
/// Times are of any steady clock [us].
class OrderedStream {
 public:
  static constexpr Utime kGrace = 4'000;
  static constexpr Utime kFirstPause = 15'000, kLongestPause = 480'000;
  static constexpr int kMaxAsked = 9;
  static constexpr std::uint32_t kMaxAhead = 4096;  ///< a number farther ahead: begins anew there
  static constexpr std::size_t kFragmentsAsked = 600;  ///< by one call of Ask

  using IsWanted = std::function<bool(const std::string& channel)>;

  /// Message `next` is the first that it takes.
  OrderedStream(std::uint32_t next, IsWanted is_wanted)
      : first_(next), next_(next), is_wanted_(std::move(is_wanted)) {}

  /// False: the message was sent before its first.
  bool Takes(std::uint32_t seq) const { return next_ - first_ > kMaxAhead || IsAt(seq, first_); }

  /// False: it had come, or is of no use. Where it contradicts what came before, `why` says how.
  bool Add(const Datagram& datagram, Utime now, const char** why);
  /// The sender sends `next` next and repeats `oldest` and later.
  void OnBeat(std::uint32_t oldest, std::uint32_t next, Utime now);
  /// Another receiver asked for these: no need to, for a while.
  void OnAskedByOthers(const std::vector<MissingParts>& parts, Utime now);

  /// What to ask for now.
  std::vector<MissingParts> Ask(Utime now);
  /// When there is something to ask, or a little before; nothing: all is whole.
  std::optional<Utime> NextAsk() const;

  /// The messages that are next, each whole, as far as they are.
  std::vector<WholeMessage> Take();
  /// Gives up the oldest message that is not whole, for its memory.
  void GiveUpOldest();

  /// Of all but what Take gives now; a number of which nothing came takes memory, too.
  std::size_t bytes_held() const { return bytes_held_ + slots_.size() * sizeof(Slot); }
  std::int64_t given_up() const { return given_up_; }  ///< messages

 private:
  struct Slot {
    std::optional<PartialMessage> partial;
    std::optional<WholeMessage> whole;
    bool settled = false;  // whole, unwanted or given up
    Utime ask_at = 0;
    int asked = 0;
  };

  static constexpr Utime kNever = std::numeric_limits<Utime>::max();

  // Numbers wrap.
  static bool IsAt(std::uint32_t seq, std::uint32_t begin) { return seq - begin < 0x80000000U; }
  Slot* At(std::uint32_t seq);
  void Reach(std::uint32_t next, Utime now);
  void AskAt(Utime when, Slot* slot);
  static MissingParts PartsOf(const Slot& slot, std::uint32_t seq, std::size_t most);
  static std::vector<std::uint16_t> Missing(const PartialMessage& message, std::size_t most);
  bool AddWhole(const Datagram& datagram, Slot* slot);
  bool AddFragment(const Datagram& fragment, Slot* slot, const char** why);
  void Settle(Slot* slot);
  void GiveUp(Slot* slot);
  void Finish(WholeMessage message, Slot* slot);
  void Advance();

  std::uint32_t first_;
  std::uint32_t next_;  // of slots_' first
  IsWanted is_wanted_;
  std::deque<Slot> slots_;           // the first is not settled
  std::vector<WholeMessage> ready_;  // before them
  std::size_t unsettled_ = 0;
  Utime earliest_ask_ = kNever;  // of none that is not settled earlier: most calls look at no slot
  std::size_t bytes_held_ = 0;   // of messages in slots_
  std::int64_t given_up_ = 0;
};

}  // namespace rgbdt
