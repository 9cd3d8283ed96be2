// Packets of a Hesai, one after the other. The first byte: of which sensor (4 bits), whether what
// tells a packet is put right, whether the angle correction file comes first in the input.
#include <iterator>

#include "services/drivers/hesai/hesai_packets.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/sweep_check.h"
#include "tests/unit/packets/hesai_encoder.h"

namespace rgbdt {
namespace {

using test::HesaiEncoder;

// The head as this sensor's are, and azimuths within a turn.
void Mend(const HesaiEncoder& encoder, const std::string& whole, std::string* packet) {
  const auto* bytes = fuzz::Data(whole);
  const hesai::Sensor& sensor = *hesai::SensorOf(bytes, whole.size());
  if (packet->size() < whole.size()) return;
  packet->replace(0, sensor.head_bytes, whole, 0, sensor.head_bytes);
  if (sensor.head_bytes == 0) packet->replace(0, 2, whole, 0, 2);
  const std::size_t beam_bytes = encoder.model == HesaiEncoder::Model::k40P ||
                                         encoder.model == HesaiEncoder::Model::k64 ||
                                         encoder.model == HesaiEncoder::Model::k128E3X
                                     ? 3
                                     : 4;
  const std::size_t block_bytes = sensor.block_head_bytes + sensor.channels * beam_bytes;
  for (std::size_t block = 0; block < sensor.blocks; ++block) {
    const std::size_t at = sensor.head_bytes + block * block_bytes + sensor.block_head_bytes - 2;
    const unsigned azimuth = static_cast<unsigned char>((*packet)[at]) |
                             static_cast<unsigned>(static_cast<unsigned char>((*packet)[at + 1]))
                                 << 8;
    (*packet)[at] = static_cast<char>(azimuth % 36000);
    (*packet)[at + 1] = static_cast<char>((azimuth % 36000) >> 8);
  }
}

void Drive(const hesai::Angles& angles, const HesaiEncoder& encoder, bool mended,
           fuzz::Input* input) {
  SpinningSweeps sweeps(angles);
  const std::vector<std::uint8_t> made_up = encoder.Packet(0, 0);
  const std::string whole(made_up.begin(), made_up.end());
  Utime arrival = 1'700'000'000'000'000;
  while (!input->empty()) {
    arrival += 64 * input->Word();
    std::string bytes = input->Take(whole.size());
    if (mended) Mend(encoder, whole, &bytes);
    const hesai::Sensor* sensor = hesai::SensorOf(fuzz::Data(bytes), bytes.size());
    if (sensor == nullptr) continue;
    fuzz::Try([&] {
      const auto packet = hesai::Decode(*sensor, fuzz::Data(bytes), bytes.size());
      for (const Cloud& sweep : sweeps.Add(packet, arrival)) fuzz::RequireWhole(sweep);
    });
  }
}

void TakeInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  const unsigned kind = input.Byte();
  const HesaiEncoder made_up{HesaiEncoder::kAll[kind % 16 % std::size(HesaiEncoder::kAll)]};
  const std::string text = (kind & 0x20) != 0 ? input.Piece() : made_up.Angles();
  fuzz::Try(
      [&] { Drive(hesai::ParseAngles(text, "angles.csv"), made_up, (kind & 0x10) != 0, &input); });
}

}  // namespace
}  // namespace rgbdt

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  rgbdt::TakeInput(data, size);
  return 0;
}
