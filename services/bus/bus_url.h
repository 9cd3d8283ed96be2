#pragma once

#include <cstdint>
#include <string>

namespace rgbdt {

/// What LCM reads of udpm://239.255.76.67:7667?ttl=0&recv_buf_size=33554432, with its defaults.
struct BusUrl {
  std::string text;
  std::string error;               ///< what is wrong with it; empty: nothing
  std::uint32_t group = 0;         ///< 239.255.76.67 = 0xefff4c43
  int port = 7667;                 ///< UDP
  int ttl = 0;                     ///< how many networks a message may cross
  std::int64_t buffer_bytes = -1;  ///< below 0: not said
};

BusUrl ParseBusUrl(const std::string& text);

}  // namespace rgbdt
