#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "calib/model/time.h"
#include "services/messages/bytes.h"

namespace rgbdt {

/// Where senders and receivers speak of what was lost between them: short messages of LCM, which
/// other LCM programs pass over. What they carry, little-endian, after a byte that says which:
///   'B' Beat:          id (8), oldest (4), next (4), datagrams (8), host_utime (8), host (the
///   rest) 'R' RepairRequest: id (8), then for each message seq (4), count (2), count fragments (2
///   each) 'D' a repair:      the datagram that was lost, as it was sent
/// A lost datagram goes out in such a wrapping and not as it was, because LCM's own receiver counts
/// the fragments that come and takes the same one twice for two: its message would have a hole.
inline constexpr char kRepairChannel[] = "RGBDT_REPAIR";

/// What a sender says of itself: once a second, and shortly after it sent something.
struct Beat {
  std::uint64_t id = 0;         ///< drawn by lot
  std::uint32_t oldest = 0;     ///< number of the oldest message that it can repeat
  std::uint32_t next = 0;       ///< number of the message that it sends next
  std::uint64_t datagrams = 0;  ///< so many sent, without what goes over kRepairChannel
  Utime host_utime = 0;         ///< its machine's wall clock [us, UTC]
  std::string host;             ///< its machine's name
};

/// What of a message did not come.
struct MissingParts {
  std::uint32_t seq = 0;
  std::vector<std::uint16_t> fragments;  ///< empty: nothing of it came; asks for its first datagram
};

/// Asks the sender `id` for what is missing.
struct RepairRequest {
  std::uint64_t id = 0;
  std::vector<MissingParts> parts;
};

/// A lost datagram.
struct Repair {
  Bytes datagram;
};

Bytes Encode(const Beat& beat);
Bytes Encode(const RepairRequest& request);

using RepairMessage = std::variant<std::monostate, Beat, RepairRequest, Repair>;
/// std::monostate where the bytes are none of these.
RepairMessage DecodeRepairMessage(const std::uint8_t* data, std::size_t size);

/// The first byte of a Repair; the datagram follows.
inline constexpr std::uint8_t kRepairMark = 'D';

}  // namespace rgbdt
