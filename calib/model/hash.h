#pragma once

#include <cstdint>

namespace rgbdt {

/// The finaliser of MurmurHash3 (Appleby): every bit of the key moves every bit of the hash.
inline std::uint64_t Hash(std::uint64_t key) {
  key ^= key >> 33;
  key *= 0xff51afd7ed558ccdULL;
  key ^= key >> 33;
  key *= 0xc4ceb9fe1a85ec53ULL;
  return key ^ (key >> 33);
}

}  // namespace rgbdt
