#include "calib/model/image_codec.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "calib/model/errors.h"

namespace rgbdt {
namespace {

constexpr std::int64_t kMostPixels = std::int64_t{1} << 27;
// No format packs more into a byte: 1032 bytes of deflate with 8 pixels each are half of it.
constexpr std::int64_t kMostPixelsOfAByte = std::int64_t{1} << 14;
constexpr std::string_view kPngSignature = "\x89PNG\r\n\x1a\n";

// OpenCV's words end in a new line, or go on in a next one.
std::string FirstLine(const std::string& text) { return text.substr(0, text.find('\n')); }

enum class Order { kBig, kLittle };

// A number of `count` bytes; who calls has looked that they are there.
std::uint32_t Unsigned(std::string_view bytes, std::size_t at, std::size_t count, Order order) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t next = order == Order::kBig ? i : count - 1 - i;
    value = value << 8 | static_cast<unsigned char>(bytes[at + next]);
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
    const std::size_t length = Unsigned(bytes, at, 4, Order::kBig);
    if (length > bytes.size() - at - 12) return false;
    if (Crc(&bytes[at + 4], length + 4) != Unsigned(bytes, at + 8 + length, 4, Order::kBig))
      return false;
    if (bytes.compare(at + 4, 4, "IEND") == 0) return true;
    at += 12 + length;
  }
  return false;
}

// Of a JPEG's frame header (ITU-T T.81, B.2.2), which is behind segments of marker, length and
// content; nothing where there is none. Codes without a length (stuffed bytes, restarts, begin,
// end) and the scan have no place before it: a decoder may pass over them and read another header.
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
    if (marker < 0xC0 || (marker >= 0xD0 && marker <= 0xDA)) return std::nullopt;
    i += 2 + 256 * std::size_t{at(i + 2)} + at(i + 3);
  }
  return std::nullopt;
}

// Of BMP's head; older ones have 16 bit, and rows from the top down a negative height.
std::optional<ImageSize> BmpSize(std::string_view bytes) {
  constexpr std::uint32_t kOldHead = 12;
  if (bytes.size() < 26) return std::nullopt;
  const auto number = [&](std::size_t at) {
    return static_cast<std::int32_t>(Unsigned(bytes, at, 4, Order::kLittle));
  };
  if (Unsigned(bytes, 14, 4, Order::kLittle) == kOldHead) {
    return ImageSize{Unsigned(bytes, 18, 2, Order::kLittle),
                     Unsigned(bytes, 20, 2, Order::kLittle)};
  }
  return ImageSize{number(18), std::abs(std::int64_t{number(22)})};
}

// Of the first directory's tags 256 and 257 (TIFF 6.0, section 2). Where tags 322 and 323 speak of
// tiles beyond the image, theirs: so much is unpacked.
std::optional<ImageSize> TiffSize(std::string_view bytes, Order order) {
  constexpr std::size_t kEntry = 12;
  constexpr std::uint32_t kShort = 3, kLong = 4;
  if (bytes.size() < 8) return std::nullopt;
  const std::size_t directory = Unsigned(bytes, 4, 4, order);
  if (directory > bytes.size() - 2) return std::nullopt;
  const std::size_t count = Unsigned(bytes, directory, 2, order);
  if (count * kEntry > bytes.size() - directory - 2) return std::nullopt;
  std::int64_t width = 0, height = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t entry = directory + 2 + i * kEntry;
    const std::uint32_t tag = Unsigned(bytes, entry, 2, order);
    const std::uint32_t type = Unsigned(bytes, entry + 2, 2, order);
    const bool is_width = tag == 256 || tag == 322, is_height = tag == 257 || tag == 323;
    if (!is_width && !is_height) continue;
    if (type != kShort && type != kLong) return std::nullopt;
    std::int64_t& side = is_width ? width : height;
    const std::int64_t said = Unsigned(bytes, entry + 8, type == kShort ? 2 : 4, order);
    side = std::max(side, said);
  }
  return ImageSize{width, height};
}

// Two numbers behind "P1" to "P6", white space and comments between. White space must follow each,
// as the format has it: OpenCV passes over whatever byte does.
std::optional<ImageSize> PnmSize(std::string_view bytes) {
  constexpr std::int64_t kMost = std::int64_t{1} << 31;
  std::array<std::int64_t, 2> sides{};
  std::size_t at = 2;
  const auto left = [&] { return at < bytes.size(); };
  const auto is_digit = [&] { return left() && bytes[at] >= '0' && bytes[at] <= '9'; };
  const auto is_space = [&] {
    return left() && std::isspace(static_cast<unsigned char>(bytes[at])) != 0;
  };
  for (std::int64_t& side : sides) {
    while (is_space() || (left() && bytes[at] == '#')) {
      at = is_space() ? at + 1 : std::min(bytes.find_first_of("\r\n", at), bytes.size());
    }
    if (!is_digit()) return std::nullopt;
    for (; is_digit(); ++at) side = std::min(kMost, 10 * side + (bytes[at] - '0'));
    if (!is_space()) return std::nullopt;
  }
  return ImageSize{sides[0], sides[1]};
}

}  // namespace

std::optional<ImageSize> StatedSize(const void* data, std::size_t size) {
  using namespace std::string_view_literals;
  const std::string_view bytes(static_cast<const char*>(data), size);
  const auto begins = [&](std::string_view text) { return bytes.substr(0, text.size()) == text; };
  if (size >= 24 && begins(kPngSignature)) {
    return ImageSize{Unsigned(bytes, 16, 4, Order::kBig), Unsigned(bytes, 20, 4, Order::kBig)};
  }
  if (begins("\xFF\xD8")) return JpegSize(bytes);
  if (begins("II*\0"sv)) return TiffSize(bytes, Order::kLittle);
  if (begins("MM\0*"sv)) return TiffSize(bytes, Order::kBig);
  if (begins("BM")) return BmpSize(bytes);
  if (size >= 3 && begins("P") && bytes[1] >= '1' && bytes[1] <= '6') return PnmSize(bytes);
  return std::nullopt;
}

bool IsTurnedByExif(const void* data, std::size_t size) {
  using namespace std::string_view_literals;
  const std::string_view bytes(static_cast<const char*>(data), size);
  const std::string_view head = bytes.substr(0, 20);
  if (size < 20 || head.substr(0, 2) != "\xFF\xD8"sv) return false;
  // APP1 comes first, or behind APP0 (Exif 2.3, 4.5.4; its TIFF head 12 bytes behind the marker).
  for (std::size_t at = 2; at + 12 < size;) {
    const auto marker = static_cast<unsigned char>(bytes[at + 1]);
    if (bytes[at] != '\xFF' || (marker != 0xE0 && marker != 0xE1)) return false;
    const std::size_t length = Unsigned(bytes, at + 2, 2, Order::kBig);
    if (marker == 0xE1 && bytes.substr(at + 4, 6) == "Exif\0\0"sv && at + 2 + length <= size &&
        length > 16) {
      const std::string_view tiff = bytes.substr(at + 10, length - 8);
      const Order order = tiff.substr(0, 2) == "MM" ? Order::kBig : Order::kLittle;
      const std::size_t directory = Unsigned(tiff, 4, 4, order);
      if (directory > tiff.size() - 2) return false;
      const std::size_t count = Unsigned(tiff, directory, 2, order);
      constexpr std::size_t kEntry = 12;
      for (std::size_t i = 0; i < count; ++i) {
        const std::size_t entry = directory + 2 + i * kEntry;
        if (entry + kEntry > tiff.size()) return false;
        if (Unsigned(tiff, entry, 2, order) != 274) continue;
        const std::uint32_t orientation = Unsigned(tiff, entry + 8, 2, order);
        return orientation > 1 && orientation <= 8;
      }
      return false;
    }
    at += 2 + length;
  }
  return false;
}

cv::Mat DecodeImage(const void* bytes, std::size_t size, const std::string& where) {
  if (size == 0) throw InputError(where + " is empty; expected an image");
  const auto said = StatedSize(bytes, size);
  if (!said) {
    throw InputError(where + " cannot be decoded as an image: expected a PNG, JPEG, TIFF, BMP or " +
                     "PNM (pgm, ppm)");
  }
  if (said->height > 0 && said->width > kMostPixels / said->height) {
    throw InputError(where + " is an image of " + std::to_string(said->width) + "x" +
                     std::to_string(said->height) + " pixels; expected at most " +
                     std::to_string(kMostPixels));
  }
  if (said->width * said->height > static_cast<std::int64_t>(size) * kMostPixelsOfAByte) {
    throw InputError(where + " says that it is an image of " + std::to_string(said->width) + "x" +
                     std::to_string(said->height) + " pixels, which its " + std::to_string(size) +
                     " bytes cannot hold");
  }
  cv::Mat image;
  std::string reason = "damaged, cut short or of an unknown format";
  try {
    if (IsWholeIfPng({static_cast<const char*>(bytes), size})) {
      const cv::Mat view(1, static_cast<int>(size), CV_8UC1, const_cast<void*>(bytes));
      image = cv::imdecode(view, cv::IMREAD_UNCHANGED);
    }
  } catch (const std::exception& error) {  // cv::Exception or bad_alloc (a forged size)
    reason = FirstLine(error.what());
  }
  if (image.empty()) throw InputError(where + " cannot be decoded as an image: " + reason);
  return image;
}

}  // namespace rgbdt
