#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "calib/model/time.h"
#include "services/messages/bytes.h"

namespace rgbdt {

// A signed message is the message as it is without a key, and these 48 bytes behind it, integers
// big-endian as LCM's. LCM's decoders stop at a message's end, so other programs read signed
// messages and logs of them as any others. How the tag is made: services/bus/signature.h.
//
//   0  sender  8 bytes by lot, of one run of one process
//   8  number  int64, of this sender's signed messages on all channels, from 0
//  16  utime   int64, the sender's wall clock [us, UTC]
//  24  tag     16 bytes
//  40  "RGBDTSG1"
struct Signature {
  std::uint64_t sender = 0;
  std::int64_t number = 0;
  Utime utime = 0;
  std::uint8_t tag[16] = {};
};

inline constexpr std::size_t kSignatureBytes = 48;
/// Of it: all before the tag, which is unlike any other's.
inline constexpr std::size_t kStampBytes = 24;

/// Whether a process with a key signs what it sends on this channel, and takes nothing there that
/// is not: what commands, decides and reports. Not what sensors measure and what is made of that
/// alone (LINE_SCAN, ENCODER, CLOUD, images, RGBDT_CLOUD, RGBDT_SWEEP, POSE, ODOMETRY,
/// TARGET_STATUS).
bool IsSignedChannel(const std::string& channel);

void AppendSignature(const Signature& signature, Bytes* message);

/// What stands behind a message; nothing where there is no signature.
std::optional<Signature> SignatureOf(const std::uint8_t* data, std::size_t size);

/// Of a message of this channel: how many bytes are its own, signed or not.
std::size_t SizeWithoutSignature(const std::string& channel, const std::uint8_t* data,
                                 std::size_t size);

}  // namespace rgbdt
