// Decode of every message's channel. The first byte says which; the type's fingerprint is put in
// front, as nothing gets past a wrong one.
#include "services/messages/codec.h"
#include "tests/fuzz/channels.h"
#include "tests/fuzz/fuzz.h"

namespace rgbdt {
namespace {

// What was taken crosses again, bit for bit.
void CrossAgain(const Message& message) {
  Bytes once;
  try {
    once = Encode(message);
  } catch (const InputError&) {  // a picture that came packed may be too large unpacked
    return;
  }
  const std::string channel = ChannelOf(message);
  Bytes twice;
  try {
    twice = Encode(Decode(channel, once.data(), once.size()));
  } catch (const InputError& error) {
    fuzz::Require(false, "a message that crosses again; " + channel + ": " + error.what());
  }
  fuzz::Require(once == twice, "the same bytes at the second crossing of " + channel);
}

}  // namespace
}  // namespace rgbdt

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rgbdt;
  static const std::vector<fuzz::Channel> channels = fuzz::Channels();
  fuzz::Input input(data, size);
  const std::size_t which = input.Byte();
  const fuzz::Channel& channel = channels[which % channels.size()];
  // A few go to the channels of other names: any camera's image, and none that is known.
  const std::string name = which >= 0xf8 ? input.Take(8) + "_IMAGE" : channel.name;
  std::string bytes(channel.fingerprint.begin(), channel.fingerprint.end());
  bytes += input.Rest();
  fuzz::Try([&] { CrossAgain(Decode(name, fuzz::Data(bytes), bytes.size())); });
  return 0;
}
