#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace rgbdt {

/// Holds that `size` bytes are exactly one value of an LCM type, so that its generated decoder can
/// be let loose on them. LCM 1.3.1's decoders trust what they read: they size a vector by the
/// count before looking whether the bytes are there (2^31 - 1: gigabytes; negative: an exception),
/// multiply counts in `int` (2^30 floats: wraps to 0, passes the check and reads past the heap),
/// take a string's length minus one for its length (0: an exception; negative: another, and the
/// position runs backwards) and do not mind bytes that are left over.
///
/// `layout` spells the type's fields in order, separated by spaces:
///   q d  8 bytes    i f  4 bytes    h  2 bytes    b  1 byte    s  a string
///   3q              three of them
///   #num_points     an int32 that counts what follows under its name
///   num_points*2d   two doubles, num_points times
///   4image_side_t   a struct that layout.cc knows, four times; its counts are its own
/// Throws InputError naming the count or string that does not fit. The fingerprint is skipped.
void CheckLayout(std::string_view layout, const std::uint8_t* data, std::size_t size);

}  // namespace rgbdt
