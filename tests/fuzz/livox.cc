// A Livox's packets, one after the other. The first byte says of which protocol, and whether what a
// packet tells of its size is put right.
#include "services/drivers/livox/livox_sweeps.h"
#include "tests/fuzz/sweep_check.h"

namespace rgbdt {
namespace {

// Version, length and number of points, as a packet of so many bytes has them.
void MendHead(livox::Protocol protocol, std::string* packet) {
  if (packet->size() < 18) return;
  (*packet)[0] = protocol == livox::Protocol::kSdk1 ? 5 : 0;
  if (protocol == livox::Protocol::kSdk1 || packet->size() < 36) return;
  const auto put = [packet](std::size_t at, std::size_t value) {
    (*packet)[at] = static_cast<char>(value);
    (*packet)[at + 1] = static_cast<char>(value >> 8);
  };
  constexpr std::size_t kBytes[] = {1, 14, 8, 10};  // of a point
  put(1, packet->size());
  put(5, (packet->size() - 36) / kBytes[(*packet)[10] & 3]);
}

void RequireSecond(const Cloud& cloud) {
  fuzz::RequireWhole(cloud);
  fuzz::Require(cloud.utime.size() == cloud.points.size(), "a time a point");
}

}  // namespace
}  // namespace rgbdt

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rgbdt;
  fuzz::Input input(data, size);
  const unsigned kind = input.Byte();
  const auto protocol = (kind & 1) != 0 ? livox::Protocol::kSdk1 : livox::Protocol::kSdk2;
  LivoxSweeps sweeps;
  Utime arrival = 1'700'000'000'000'000;
  while (!input.empty()) {
    arrival += 64 * input.Word();
    std::string bytes = input.Piece();
    if ((kind & 2) != 0) MendHead(protocol, &bytes);
    fuzz::Try([&] {
      const auto packet = livox::Decode(protocol, fuzz::Data(bytes), bytes.size());
      fuzz::Require(static_cast<int>(packet.points.size()) + packet.dropped <= packet.beams,
                    "a point a beam");
      if (const auto cloud = sweeps.Add(packet, arrival)) RequireSecond(*cloud);
    });
  }
  if (const auto last = sweeps.Finish()) RequireSecond(*last);
  return 0;
}
