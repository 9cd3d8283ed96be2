#pragma once

#include <cstdint>

#include "calib/model/time.h"

namespace rgbdt {

/// How long a cloud of a Livox is: its pattern does not repeat, and within a second it has seen
/// most of its field. Rig and board stand still meanwhile.
inline constexpr Utime kLivoxCloudUs = kMicrosecondsPerSecond;

/// Whether the vendor calls a point normal, by bits 0 to 3 of its tag: of a Mid-360 its confidence
/// that it is no bridge between two things (0, 1) and no rain, fog or dust (2, 3); of an Avia,
/// noise by place and by intensity. Bits 4 and 5 are a confidence (Mid-360) or the return's number
/// (Avia): data do not say which, so they are not looked at.
inline bool IsNormalLivoxPoint(std::uint8_t tag) { return (tag & 0x0fU) == 0; }

}  // namespace rgbdt
