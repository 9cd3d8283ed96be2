#pragma once

#include <cstdint>
#include <string>

#include "services/messages/bytes.h"
#include "services/messages/message.h"

namespace rgbdt {

// Sender and receiver apply the same rules (check.h): Encode refuses what Decode would refuse, so
// an error names the process that made a bad message.
//
// What has crossed the bus once crosses again bit for bit. On the first crossing:
// - a cloud's vectors come back as long as its points, so that chunks can be joined; what was
//   empty is NaN (directions, intensity), 65535 (ring) or the sweep's time (utime). Origins stay
//   empty. A miss' direction travels; a hit's is NaN and follows from its point (DirectionOf).
// - a quaternion is normalised.
// - a JPEG or PNG arrives decoded, as kMono8, kMono16 or kBgr8. To send one, give an Image the
//   format kJpeg or kPng and plain pixels: Encode compresses them.
// - a radiometry of kind kNone comes back as the default.
// - a fused cloud without a pose has the frame_utime 0.
// - a rig's own time is not known here and travels as 0.

/// The message as bytes of its LCM type. Throws InputError, naming field and value, where it does
/// not fit the type or breaks a rule, and where it takes more than the 3 MB that the bus carries.
Bytes Encode(const Message& message);

/// The message of a channel, decoded and checked: lengths, counts, ranges, enums, finite numbers
/// where they must be. A signature behind it is passed over, unjudged. Never reads past `size`;
/// takes memory in proportion to `size` (a compressed image: to its pixels, 2^26 at most). Throws
/// InputError naming the field and its value, or the channel if no type belongs to it.
Message Decode(const std::string& channel, const std::uint8_t* data, std::size_t size);

/// The file of an image that was sent as JPEG or PNG, for who passes it on as it is; empty for one
/// whose pixels travel plain. Of a message of a camera's channel that Decode takes.
Bytes ImageFileOf(const std::uint8_t* data, std::size_t size);

}  // namespace rgbdt
