#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "calib/model/time.h"
#include "services/bus/internal/repair_message.h"
#include "services/messages/bytes.h"

namespace rgbdt {

/// A message cut into datagrams of LCM that fit an Ethernet's MTU of 1500, so that what a network
/// loses is a datagram and not, for one lost piece of 44, 64 KB of the message.
class SentMessage {
 public:
  /// A datagram at most, with room for a Repair's wrapping: IP (20), UDP (8), LCM (8), channel (13)
  /// and mark (1) make 1450.
  static constexpr std::size_t kDatagramBytes = 1400;

  SentMessage(std::uint32_t seq, std::string channel, Bytes bytes);

  /// Throws nothing; false: it has more fragments than LCM can count.
  static bool Fits(const std::string& channel, std::size_t bytes);

  std::uint32_t seq() const { return seq_; }
  std::size_t datagrams() const { return datagrams_; }  ///< 1: a short message
  std::size_t bytes() const { return bytes_.size(); }
  /// What stands before the data in datagram `number`.
  Bytes Header(std::size_t number) const;
  /// The data of datagram `number`: a part of the message.
  std::pair<const std::uint8_t*, std::size_t> Data(std::size_t number) const;

 private:
  std::size_t Begin(std::size_t number) const;

  std::uint32_t seq_;
  std::string channel_;
  Bytes bytes_;
  std::size_t datagrams_;
};

/// The newest messages of a sender, to be repeated where a receiver asks: those of kKept, 64 MiB of
/// them at most. What it repeats is bounded, so that receivers that lose because the network is
/// full do not fill it: a datagram again only kPause after it was repeated (several receivers miss
/// it and each asks), and so many bytes a second.
class SentMessages {
 public:
  static constexpr Utime kKept = 4 * kMicrosecondsPerSecond;
  static constexpr std::size_t kMaxBytes = std::size_t{64} << 20;
  static constexpr Utime kPause = 8'000;
  static constexpr std::int64_t kRepeatedPerSecond = 8'000'000, kRepeatedAtOnce = 2'000'000;

  /// It Fits. Times are of any steady clock [us].
  const SentMessage& Add(std::string channel, Bytes bytes, Utime now);

  /// The datagrams that `parts` ask for, as far as they are kept and may go.
  std::vector<Bytes> Repeat(const std::vector<MissingParts>& parts, Utime now);

  std::uint32_t oldest() const { return next_ - static_cast<std::uint32_t>(kept_.size()); }
  std::uint32_t next() const { return next_; }

 private:
  struct Kept {
    SentMessage message;
    Utime sent;
    std::map<std::size_t, Utime> repeated;  // datagrams, when
  };
  void Forget(Utime now);

  std::deque<Kept> kept_;
  std::size_t bytes_ = 0;
  std::uint32_t next_ = 0;
  std::int64_t allowance_ = kRepeatedAtOnce;  // bytes
  Utime allowed_at_ = 0;
};

}  // namespace rgbdt
