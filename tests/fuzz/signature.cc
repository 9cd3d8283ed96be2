// What a process with a key makes of signatures: one message after the other, each a byte and a
// piece. The byte says whose it is: a stranger's, another process', one that was changed on its
// way, or one of somebody who has the key and signs any number and time; and on which channel.
#include "services/bus/signature.h"

#include <algorithm>
#include <iterator>

#include "tests/fuzz/fuzz.h"
#include "tests/unit/bus/bus_key.h"

namespace rgbdt {
namespace {

enum Whose : unsigned { kStrangers, kOwn, kChanged, kLiars };
constexpr unsigned kOtherChannel = 4;
constexpr Utime kNow = 1'700'000'000'000'000;

// The right tag for any stamp.
void SignAnyStamp(const std::string& channel, std::string stamp, ChannelKeys* keys,
                  Bytes* message) {
  const std::size_t size = message->size();
  AppendSignature({}, message);
  stamp.resize(kStampBytes);
  const auto at = message->begin() + static_cast<std::ptrdiff_t>(size);
  std::copy(stamp.begin(), stamp.end(), at);
  std::uint8_t tag[sizeof(Signature::tag)];
  keys->Tag(channel, message->data(), size, tag);
  std::copy(std::begin(tag), std::end(tag), at + kStampBytes);
}

void TakeInput(fuzz::Input input) {
  MessageSigner signer(KeyOf(7));
  ChannelKeys keys(KeyOf(7));
  SignatureCheck check(KeyOf(7));
  while (!input.empty()) {
    const unsigned kind = input.Byte();
    const std::string channel = (kind & kOtherChannel) != 0 ? "RIG" : "SESSION_COMMAND";
    const std::string piece = input.Piece();
    Bytes message(piece.begin(), piece.end());
    const auto taken = [&] {
      return check.WhyNot(channel, message.data(), message.size(), kNow).empty();
    };
    switch (kind % kOtherChannel) {
      case kStrangers:
        fuzz::Require(!taken(), "nothing of who has no key");
        break;
      case kOwn:
        signer.Sign(channel, kNow, &message);
        fuzz::Require(taken(), "what another process of the rig sends");
        fuzz::Require(!taken(), "that, once");
        break;
      case kChanged:
        signer.Sign(channel, kNow, &message);
        message[input.Word() % message.size()] ^= static_cast<std::uint8_t>(input.Byte() | 1U);
        fuzz::Require(!taken(), "nothing that was changed");
        break;
      case kLiars:
        SignAnyStamp(channel, input.Take(kStampBytes), &keys, &message);
        taken();
        fuzz::Require(!taken(), "nothing twice");
        break;
    }
  }
}

}  // namespace
}  // namespace rgbdt

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  rgbdt::TakeInput({data, size});
  return 0;
}
