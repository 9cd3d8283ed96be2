// What a receiver of the bus makes of datagrams: of several senders, short, fragments, or rubbish.
// Each is a byte (sender; whether the magic is put right, and to which) and a piece.
#include "services/bus/internal/datagram.h"
#include "services/bus/internal/reassembly.h"
#include "services/messages/limits.h"
#include "tests/fuzz/fuzz.h"

namespace rgbdt {
namespace {

constexpr unsigned kRaw = 0x80, kFragment = 0x40;

std::string TakeDatagram(unsigned kind, fuzz::Input* input) {
  std::string bytes = input->Piece();
  if ((kind & kRaw) == 0) bytes.insert(0, (kind & kFragment) != 0 ? "LC03" : "LC02");
  return bytes;
}

}  // namespace
}  // namespace rgbdt

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rgbdt;
  Reassembly reassembly([](const std::string& channel) { return channel[0] != 'X'; });
  fuzz::Input input(data, size);
  while (!input.empty()) {
    const unsigned kind = input.Byte();
    const std::string bytes = TakeDatagram(kind, &input);
    const char* why = nullptr;
    const auto datagram = ParseDatagram(fuzz::Data(bytes), bytes.size(), &why);
    fuzz::Require(datagram.has_value() || why != nullptr, "a reason for what is refused");
    if (!datagram) continue;
    why = nullptr;
    const Reassembly::Sender sender(kind & 0x3f, 7667);
    const auto whole = reassembly.Add(sender, *datagram, &why);
    if (whole && datagram->is_fragment) {
      fuzz::Require(whole->bytes.size() == datagram->message_bytes, "a message that is whole");
    }
    fuzz::Require(
        reassembly.bytes_held() <= std::size_t{64} << 20 && reassembly.senders_held() <= 256,
        "no more held than is promised");
  }
  return 0;
}
