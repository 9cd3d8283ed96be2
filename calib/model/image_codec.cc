#include "calib/model/image_codec.h"

#include <array>
#include <cstdint>
#include <exception>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "calib/model/errors.h"

namespace rgbdt {
namespace {

constexpr std::int64_t kMostPixels = std::int64_t{1} << 27;
constexpr std::string_view kPngSignature = "\x89PNG\r\n\x1a\n";

std::uint32_t BigEndian(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  }
  return value;
}

// CRC-32 as PNG's chunks carry it (ISO 3309).
std::uint32_t Crc(const char* bytes, std::size_t size) {
  static const std::array<std::uint32_t, 256> table = [] {
    std::array<std::uint32_t, 256> entries{};
    for (std::uint32_t i = 0; i < 256; ++i) {
      std::uint32_t entry = i;
      for (int bit = 0; bit < 8; ++bit) entry = (entry >> 1) ^ ((entry & 1) * 0xEDB88320u);
      entries[i] = entry;
    }
    return entries;
  }();
  std::uint32_t crc = 0xFFFFFFFFu;
  for (std::size_t i = 0; i < size; ++i) {
    crc = table[(crc ^ static_cast<unsigned char>(bytes[i])) & 255] ^ (crc >> 8);
  }
  return ~crc;
}

// Whether a PNG is all there and undamaged; true for other formats. Looked at before decoding,
// because libpng would complain on stderr.
bool IsWholeIfPng(std::string_view bytes) {
  if (bytes.compare(0, 8, kPngSignature) != 0) return true;
  std::size_t at = 8;
  while (bytes.size() - at >= 12) {
    const std::size_t length = BigEndian(bytes, at);
    if (length > bytes.size() - at - 12) return false;
    if (Crc(&bytes[at + 4], length + 4) != BigEndian(bytes, at + 8 + length)) return false;
    if (bytes.compare(at + 4, 4, "IEND") == 0) return true;
    at += 12 + length;
  }
  return false;
}

// Of a JPEG's frame header (ITU-T T.81, B.2.2), which is behind segments of marker, length and
// content; nothing where there is none.
std::optional<ImageSize> JpegSize(std::string_view bytes) {
  const auto at = [&](std::size_t i) { return static_cast<unsigned char>(bytes[i]); };
  for (std::size_t i = 2; i + 9 <= bytes.size() && at(i) == 0xFF;) {
    const int marker = at(i + 1);
    if (marker == 0xFF) {  // fill
      ++i;
      continue;
    }
    const bool tables = marker == 0xC4 || marker == 0xC8 || marker == 0xCC;
    if (marker >= 0xC0 && marker <= 0xCF && !tables) {
      return ImageSize{256 * at(i + 7) + at(i + 8), 256 * at(i + 5) + at(i + 6)};
    }
    i += 2 + 256 * std::size_t{at(i + 2)} + at(i + 3);
  }
  return std::nullopt;
}

}  // namespace

std::optional<ImageSize> StatedSize(const void* data, std::size_t size) {
  const std::string_view bytes(static_cast<const char*>(data), size);
  if (size >= 24 && bytes.compare(0, 8, kPngSignature) == 0) {
    return ImageSize{BigEndian(bytes, 16), BigEndian(bytes, 20)};
  }
  return bytes.compare(0, 2, "\xFF\xD8") == 0 ? JpegSize(bytes) : std::nullopt;
}

cv::Mat DecodeImage(const void* bytes, std::size_t size, const std::string& where) {
  if (size == 0) throw InputError(where + " is empty; expected an image");
  const auto said = StatedSize(bytes, size);
  if (said && said->height > 0 && said->width > kMostPixels / said->height) {
    throw InputError(where + " is an image of " + std::to_string(said->width) + "x" +
                     std::to_string(said->height) + " pixels; expected at most " +
                     std::to_string(kMostPixels));
  }
  cv::Mat image;
  std::string reason = "damaged, cut short or of an unknown format";
  try {
    if (IsWholeIfPng({static_cast<const char*>(bytes), size})) {
      const cv::Mat view(1, static_cast<int>(size), CV_8UC1, const_cast<void*>(bytes));
      image = cv::imdecode(view, cv::IMREAD_UNCHANGED);
    }
  } catch (const std::exception& error) {  // cv::Exception or bad_alloc (a forged size)
    reason = error.what();
  }
  if (image.empty()) throw InputError(where + " cannot be decoded as an image: " + reason);
  return image;
}

}  // namespace rgbdt
