// An image file, and what its EXIF says. Where the first byte is odd a PNG's chunks get the sums
// that they should have: a decoder looks at nothing behind a wrong one.
#include <zlib.h>

#include "calib/files/image_files.h"
#include "calib/model/image_codec.h"
#include "tests/fuzz/fuzz.h"

namespace rgbdt {
namespace {

std::uint32_t BigEndian(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  }
  return value;
}

void MendSums(std::string* png) {
  constexpr std::size_t kSignature = 8, kAround = 12;  // length, name and sum
  for (std::size_t at = kSignature; at + kAround <= png->size();) {
    const std::size_t length = BigEndian(*png, at);
    if (length > png->size() - at - kAround) return;
    const auto sum = static_cast<std::uint32_t>(
        crc32(0, fuzz::Data(*png) + at + 4, static_cast<unsigned>(length) + 4));
    for (std::size_t i = 0; i < 4; ++i) {
      (*png)[at + 8 + length + i] = static_cast<char>(sum >> (24 - 8 * i));
    }
    at += kAround + length;
  }
}

}  // namespace
}  // namespace rgbdt

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rgbdt;
  fuzz::Input input(data, size);
  const bool mend = input.Byte() % 2 == 1;
  std::string bytes = input.Rest();
  if (mend) MendSums(&bytes);
  IsTurnedByExif(bytes.data(), bytes.size());
  fuzz::Try([&] {
    cv::Mat pixels = DecodeImage(bytes.data(), bytes.size(), "image");
    const auto said = StatedSize(bytes.data(), bytes.size());
    const bool is_tiff = bytes.substr(0, 2) == "II" || bytes.substr(0, 2) == "MM";
    if (is_tiff) {  // tiles may be larger than the image
      fuzz::Require(said && said->width >= pixels.cols && said->height >= pixels.rows,
                    "a TIFF no larger than its head says");
    } else {
      fuzz::Require(said && said->width == pixels.cols && said->height == pixels.rows,
                    "an image as large as its head says");
    }
    FormatOf(PixelFormat{}, &pixels);
  });
  return 0;
}
