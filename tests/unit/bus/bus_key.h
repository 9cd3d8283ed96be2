#pragma once

#include <cstdint>

#include "services/bus/signature.h"

namespace rgbdt {

/// A key whose bytes are all the same.
inline BusKey KeyOf(std::uint8_t byte) {
  BusKey key;
  key.bytes.fill(byte);
  return key;
}

}  // namespace rgbdt
