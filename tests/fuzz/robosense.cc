// Packets of a RoboSense, one after the other. The first byte: of which sensor (3 bits), whether
// what tells a packet is put right, whether its angles come first in the input, or by its packets.
#include <iterator>

#include "services/drivers/packets/packet_sweeps.h"
#include "services/drivers/robosense/robosense_packets.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/sweep_check.h"
#include "tests/unit/packets/robosense_encoder.h"

namespace rgbdt {
namespace {

using test::RobosenseEncoder;

// The head as this sensor's are, the blocks' flags, and azimuths within a turn.
void Mend(const std::vector<std::uint8_t>& whole, std::vector<std::uint8_t>* packet) {
  if (packet->size() < whole.size()) return;
  std::copy(whole.begin(), whole.begin() + 8, packet->begin());
  std::copy(whole.begin() + 30, whole.begin() + 33, packet->begin() + 30);
  for (std::size_t at = 42; at + 100 <= 1242; at += 100) {
    (*packet)[at] = 0xff;
    (*packet)[at + 1] = 0xee;
    const unsigned azimuth = ((*packet)[at + 2] << 8 | (*packet)[at + 3]) % 36000;
    (*packet)[at + 2] = static_cast<std::uint8_t>(azimuth >> 8);
    (*packet)[at + 3] = static_cast<std::uint8_t>(azimuth);
  }
}

void Drive(PacketSweeps* sweeps, const RobosenseEncoder& encoder, bool mended, fuzz::Input* input) {
  const std::vector<std::uint8_t> whole = encoder.Packet(0, 0);
  Utime arrival = 1'700'000'000'000'000;
  while (!input->empty()) {
    arrival += 64 * input->Word();
    const std::string piece = input->Take(whole.size());
    std::vector<std::uint8_t> bytes(piece.begin(), piece.end());
    const bool told = robosense::IsInformation(bytes.data(), bytes.size());
    if (mended && !told) Mend(whole, &bytes);
    if (!sweeps->IsOurs(bytes)) continue;
    fuzz::Try([&] {
      for (const Cloud& sweep : sweeps->Add(bytes, arrival)) fuzz::RequireWhole(sweep);
    });
  }
}

void TakeInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  const unsigned kind = input.Byte();
  const RobosenseEncoder made_up{
      RobosenseEncoder::kAll[kind % 8 % std::size(RobosenseEncoder::kAll)]};
  const std::string text = (kind & 0x10) != 0 ? input.Piece() : made_up.Angles();
  fuzz::Try([&] {
    const auto sweeps =
        (kind & 0x20) != 0 ? RobosensePackets() : PacketsByMetadata(text, "angle.csv");
    Drive(sweeps.get(), made_up, (kind & 0x08) != 0, &input);
  });
}

}  // namespace
}  // namespace rgbdt

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  rgbdt::TakeInput(data, size);
  return 0;
}
