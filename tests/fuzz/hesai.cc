// Packets of a Hesai, one after the other. The first byte: of which sensor (2 bits), whether what
// tells a packet is put right, whether the angle correction file comes first in the input.
#include "services/drivers/hesai/hesai_sweeps.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/sweep_check.h"
#include "tests/unit/packets/hesai_encoder.h"

namespace rgbdt {
namespace {

// The head, and azimuths within a turn.
void Mend(const hesai::Sensor& sensor, std::string* packet) {
  if (packet->size() < sensor.PacketBytes()) return;
  const auto put = [&](std::size_t at, std::size_t byte) {
    (*packet)[at] = static_cast<char>(byte);
  };
  const bool headed = sensor.head_bytes != 0;
  put(0, headed ? 0xee : 0xff);
  put(1, headed ? 0xff : 0xee);
  if (headed) {
    put(6, sensor.channels);
    put(7, sensor.blocks);
  }
  for (std::size_t block = 0; block < sensor.blocks; ++block) {
    const std::size_t at =
        sensor.head_bytes + block * sensor.BlockBytes() + sensor.block_head_bytes - 2;
    const unsigned azimuth = static_cast<unsigned char>((*packet)[at]) |
                             static_cast<unsigned>(static_cast<unsigned char>((*packet)[at + 1]))
                                 << 8;
    put(at, azimuth % 36000);
    put(at + 1, (azimuth % 36000) >> 8);
  }
}

void Drive(const hesai::Angles& angles, bool mended, fuzz::Input* input) {
  HesaiSweeps sweeps(angles);
  Utime arrival = 1'700'000'000'000'000;
  while (!input->empty()) {
    arrival += 64 * input->Word();
    std::string bytes = input->Take(sweeps.sensor().PacketBytes());
    if (mended) Mend(sweeps.sensor(), &bytes);
    fuzz::Try([&] {
      const auto packet = hesai::Decode(sweeps.sensor(), fuzz::Data(bytes), bytes.size());
      for (const Cloud& sweep : sweeps.Add(packet, arrival)) fuzz::RequireWhole(sweep);
    });
  }
}

void TakeInput(const std::uint8_t* data, std::size_t size) {
  constexpr int kChannels[] = {40, 32, 16, 16};
  fuzz::Input input(data, size);
  const unsigned kind = input.Byte();
  test::HesaiEncoder made_up;
  made_up.channels = kChannels[kind % 4];
  const std::string text = (kind & 8) != 0 ? input.Piece() : made_up.Angles();
  fuzz::Try([&] { Drive(hesai::ParseAngles(text, "angles.csv"), (kind & 4) != 0, &input); });
}

}  // namespace
}  // namespace rgbdt

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  rgbdt::TakeInput(data, size);
  return 0;
}
