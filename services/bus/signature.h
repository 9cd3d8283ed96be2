#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>

#include "calib/model/time.h"
#include "services/bus/bus_key.h"
#include "services/messages/signature.h"

namespace rgbdt {

// Each channel has a key of its own: BLAKE2b-256 (RFC 7693) of "rgbdt signature 1" and its name,
// keyed with the rig's. The tag is that of XChaCha20-Poly1305 (IETF) by the channel's key, for an
// empty text, with the message as its additional data and the signature's first kStampBytes as
// nonce. No public keys: every process of a rig both sends and judges, so all would hold a secret
// anyway.

/// The channels' keys, each made once.
class ChannelKeys {
 public:
  explicit ChannelKeys(const BusKey& key) : key_(key) {}
  /// The tag of a message with its stamp behind it.
  void Tag(const std::string& channel, const std::uint8_t* message, std::size_t size,
           std::uint8_t (&tag)[sizeof(Signature::tag)]);

 private:
  BusKey key_;
  std::map<std::string, BusKey> of_channels_;  // those of IsSignedChannel
};

/// Signs what one process sends.
class MessageSigner {
 public:
  /// Draws the sender's number by lot.
  explicit MessageSigner(const BusKey& key);

  /// It is `now` [us, UTC] by the wall clock.
  void Sign(const std::string& channel, Utime now, Bytes* message);

 private:
  ChannelKeys keys_;
  std::uint64_t sender_;
  std::int64_t next_ = 0;
};

/// Judges what one subscriber gets. What it remembers against replays is bounded by time: of each
/// sender the newest 64 numbers, until what it signed last is too old anyway.
class SignatureCheck {
 public:
  /// How far sender's and receiver's wall clocks may differ, the way between them included.
  static constexpr Utime kMostApart = 10 * kMicrosecondsPerSecond;

  explicit SignatureCheck(const BusKey& key) : keys_(key) {}

  /// Why the message is not to be taken; empty: it is, without its last kSignatureBytes, and never
  /// again. `arrived` [us, UTC] is of the wall clock.
  std::string WhyNot(const std::string& channel, const std::uint8_t* data, std::size_t size,
                     Utime arrived);

  std::size_t senders() const { return senders_.size(); }

 private:
  struct Sender {
    std::int64_t newest = -1;  // number
    std::uint64_t came = 0;    // bit k: newest - k has come
    Utime utime = 0;           // the latest that it signed
  };

  bool IsNew(const Signature& signature, Utime arrived);
  void ForgetThoseBefore(Utime utime);

  ChannelKeys keys_;
  std::map<std::uint64_t, Sender> senders_;
  Utime forgotten_at_ = 0;
};

}  // namespace rgbdt
