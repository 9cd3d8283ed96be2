#pragma once

#include <string>
#include <vector>

#include "services/messages/codec.h"
#include "services/messages/image_channel.h"
#include "services/runtime/node.h"
#include "tests/fuzz/channels.h"
#include "tests/fuzz/fuzz.h"

namespace rgbdt::fuzz {

/// What is left of `input` as messages for a node, as a process hands them on: again and again a
/// byte for the channel and a piece, the message without its fingerprint; or a byte that lets time
/// go by. What the node says must be messages.
inline void Feed(Input* input, Node* node) {
  constexpr unsigned kLater = 0xff;  // in place of a channel
  static const std::vector<Channel> channels = Channels();
  const auto publish = [](const Messages& said) {
    for (const Message& message : said) Encode(message);
  };
  Utime now = 0;
  const auto advance = [&] {
    now += kMicrosecondsPerSecond / 2;
    Try([&] { publish(node->Advance(now)); });
  };
  while (!input->empty()) {
    const unsigned which = input->Byte();
    if (which == kLater) {
      advance();
      continue;
    }
    constexpr unsigned kOther = 0x80;
    const Channel& channel = channels[which % kOther % channels.size()];
    std::string name = channel.name;
    // One of the rig's, whatever the camera is called of which there is an image in `channels`.
    if (IsImageChannel(name)) name = which < kOther ? "RGB_IMAGE" : "THERMAL_IMAGE";
    std::string bytes(channel.fingerprint.begin(), channel.fingerprint.end());
    bytes += input->Piece();
    Try([&] { publish(node->Handle(Decode(name, Data(bytes), bytes.size()))); });
    Require(node->GetStatus().text.size() < 10'000, "a status of some lines");
  }
  advance();
}

}  // namespace rgbdt::fuzz
