// What servos answer. A piece is put into a status packet with the sum that it should have, or into
// an instruction, of which two-wire buses hear the echo, or comes as it is.
#include "services/drivers/dynamixel/dynamixel_protocol.h"
#include "tests/fuzz/fuzz.h"

namespace rgbdt {
namespace {

// FF FF FD 00, id, length, instruction 55, error and parameters, CRC.
dynamixel::Bytes Framed(unsigned id, const std::string& piece) {
  const std::size_t length = piece.size() + 3;
  dynamixel::Bytes bytes = {0xff,
                            0xff,
                            0xfd,
                            0x00,
                            static_cast<std::uint8_t>(id),
                            static_cast<std::uint8_t>(length),
                            static_cast<std::uint8_t>(length >> 8),
                            0x55};
  bytes.insert(bytes.end(), piece.begin(), piece.end());
  const std::uint16_t sum = dynamixel::Crc16(bytes.data(), bytes.size());
  bytes.push_back(static_cast<std::uint8_t>(sum));
  bytes.push_back(static_cast<std::uint8_t>(sum >> 8));
  return bytes;
}

void Look(const dynamixel::Status& status) {
  fuzz::Require(status.parameters.size() <= dynamixel::StatusDecoder::kMaxLength,
                "no more parameters than a packet may have");
  fuzz::Require(!dynamixel::ErrorInWords(status.ErrorNumber()).empty(), "an error in words");
  const std::size_t size = status.parameters.size();
  if (size == 1 || size == 2 || size == 4) {
    const auto value = dynamixel::SignedFrom(status.parameters);
    fuzz::Require(dynamixel::ToBytes(value, static_cast<int>(size)) == status.parameters,
                  "the same bytes of a number");
    const auto number = dynamixel::UnsignedFrom(status.parameters);
    dynamixel::HardwareErrorInWords(static_cast<int>(number & 0xff));
  }
}

}  // namespace
}  // namespace rgbdt

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rgbdt;
  fuzz::Input input(data, size);
  dynamixel::StatusDecoder decoder;
  while (!input.empty()) {
    const unsigned kind = input.Byte();
    const std::string piece = input.Take(input.Byte());
    if (kind < 0x40) {
      decoder.Add(Framed(kind, piece));
    } else if (kind < 0x80) {
      decoder.Add(
          dynamixel::EncodeWrite(static_cast<int>(kind), 116, {piece.begin(), piece.end()}));
    } else {
      decoder.Add({piece.begin(), piece.end()});
    }
    if (kind == 0xff) decoder.Clear();
    while (const auto status = decoder.Next()) Look(*status);
  }
  return 0;
}
