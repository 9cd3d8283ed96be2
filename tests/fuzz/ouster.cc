// Packets of an Ouster, one after the other. The first byte: how they are laid out (2 bits),
// whether each column's place and state are put right, whether the metadata come first in the
// input.
#include "services/drivers/ouster/ouster_sweeps.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/sweep_check.h"
#include "tests/unit/packets/ouster_encoder.h"

namespace rgbdt {
namespace {

constexpr const char* kProfiles[] = {"LEGACY", "RNG19_RFL8_SIG16_NIR16",
                                     "RNG19_RFL8_SIG16_NIR16_DUAL", "RNG15_RFL8_NIR8"};

// Of the largest ones a turn takes too long for inputs by the million.
bool IsSmall(const ouster::Metadata& metadata) {
  return metadata.rows * metadata.columns_per_frame <= 1 << 14;
}

// A column begins with its time (8 bytes) and its place (2); behind that, or of legacy packets at
// its end, stands whether it was measured.
void MendColumns(const ouster::Metadata& metadata, std::string* packet) {
  const bool legacy = metadata.profile == ouster::Profile::kLegacy;
  const std::size_t bytes = metadata.ColumnBytes();
  for (std::size_t at = legacy ? 0 : 32; at + bytes <= packet->size(); at += bytes) {
    const auto byte = [&](std::size_t i) -> char& { return (*packet)[at + i]; };
    const int place =
        (static_cast<unsigned char>(byte(8)) | static_cast<unsigned char>(byte(9)) << 8) %
        metadata.columns_per_frame;
    byte(8) = static_cast<char>(place);
    byte(9) = static_cast<char>(place >> 8);
    byte(legacy ? bytes - 4 : 10) |= 1;
  }
}

void Drive(const ouster::Metadata& metadata, bool mended, fuzz::Input* input) {
  OusterSweeps sweeps(metadata);
  Utime arrival = 1'700'000'000'000'000;
  while (!input->empty()) {
    arrival += 64 * input->Word();
    std::string bytes = input->Take(metadata.PacketBytes());
    if (mended) MendColumns(metadata, &bytes);
    fuzz::Try([&] {
      const auto packet = ouster::Decode(metadata, fuzz::Data(bytes), bytes.size());
      if (const auto sweep = sweeps.Add(packet, arrival)) fuzz::RequireWhole(*sweep);
    });
  }
  if (const auto sweep = sweeps.Finish()) fuzz::RequireWhole(*sweep);
}

void TakeInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  const unsigned kind = input.Byte();
  test::OusterEncoder made_up;
  made_up.profile = kProfiles[kind % 4];
  const std::string text = (kind & 8) != 0 ? input.Piece() : made_up.Metadata();
  std::optional<ouster::Metadata> metadata;
  fuzz::Try([&] { metadata = ouster::ParseMetadata(text, "os.json"); });
  if (metadata && IsSmall(*metadata)) Drive(*metadata, (kind & 4) != 0, &input);
}

}  // namespace
}  // namespace rgbdt

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  rgbdt::TakeInput(data, size);
  return 0;
}
