// What a GigE Vision camera answers, and frames in every format. The first byte says which.
#include "services/drivers/camera/gvcp_message.h"
#include "services/drivers/camera/internal/frame_format.h"
#include "tests/fuzz/fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rgbdt;
  constexpr std::uint16_t kId = 0x1234;
  constexpr GenicamFormat kFormats[] = {
      GenicamFormat::kMono8,    GenicamFormat::kMono10,       GenicamFormat::kMono12,
      GenicamFormat::kMono14,   GenicamFormat::kMono16,       GenicamFormat::kMono12Packed,
      GenicamFormat::kMono12p,  GenicamFormat::kBayerGr8,     GenicamFormat::kBayerRg8,
      GenicamFormat::kBayerGb8, GenicamFormat::kBayerBg8,     GenicamFormat::kRgb8,
      GenicamFormat::kBgr8,     static_cast<GenicamFormat>(7)};
  fuzz::Input input(data, size);
  const unsigned kind = input.Byte();
  if (kind < std::size(kFormats)) {
    const int width = static_cast<std::int16_t>(input.Word());
    const int height = static_cast<std::int16_t>(input.Word());
    const std::string bytes = input.Rest();
    fuzz::Try([&] {
      const Pixels frame = PixelsOf(static_cast<std::uint32_t>(kFormats[kind]), bytes.data(),
                                    bytes.size(), width, height);
      fuzz::Require(frame.pixels.cols == width && frame.pixels.rows == height, "the frame's size");
    });
    return 0;
  }
  std::string text = input.Rest();
  if (kind % 2 == 1 && text.size() >= 8) text.replace(6, 2, "\x12\x34");  // the answer to our id
  const std::vector<std::uint8_t> bytes(text.begin(), text.end());
  ParseGvcpRegister(bytes, kId);
  if (const auto device = ParseGvcpDiscovery(bytes, kId)) {
    fuzz::Require(device->model.find('\n') == std::string::npos, "a model in one line");
  }
  return 0;
}
