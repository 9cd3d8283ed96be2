#pragma once

#include <string>
#include <vector>

#include "services/messages/codec.h"
#include "tests/unit/messages/random_messages.h"

namespace rgbdt::fuzz {

/// A message's channel, and how its bytes begin.
struct Channel {
  std::string name;
  Bytes fingerprint;
};

/// Each message's, in the order of RandomMessages::OneOfEach, and last a whole fused sweep's.
inline std::vector<Channel> Channels() {
  testing::RandomMessages random(1);
  Messages messages = random.OneOfEach();
  RgbdtCloud sweep;
  sweep.sweep_utime = 1;
  sweep.whole_sweep = true;
  messages.emplace_back(sweep);
  std::vector<Channel> channels;
  for (const Message& message : messages) {
    const Bytes bytes = Encode(message);
    channels.push_back({ChannelOf(message), Bytes(bytes.begin(), bytes.begin() + 8)});
  }
  return channels;
}

}  // namespace rgbdt::fuzz
