#pragma once

#include <cstdint>
#include <string>

#include "services/bus/bus.h"
#include "services/nodes/message.h"

namespace rgbdt {

/// The message as bytes of its LCM type. Throws InputError where it does not fit the type (a cloud
/// whose vectors differ in length, an encoding above the 3 MB that the bus carries).
Bytes Encode(const Message& message);

/// The message of a channel, decoded and checked: lengths, counts, ranges, enums, finite numbers
/// where they must be. Never reads past `size`. Throws InputError naming the field and its value.
Message Decode(const std::string& channel, const std::uint8_t* data, std::size_t size);

}  // namespace rgbdt
