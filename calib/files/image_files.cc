#include "calib/files/image_files.h"

#include <array>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "calib/files/atomic_file.h"
#include "calib/model/errors.h"

namespace rgbdt {
namespace {

std::string Describe(const cv::Mat& image) {
  static const char* const kDepths[] = {"8-bit",         "signed 8-bit",  "16-bit",
                                        "signed 16-bit", "signed 32-bit", "32-bit float",
                                        "64-bit float",  "16-bit float"};
  return std::to_string(image.channels()) + "-channel " + kDepths[image.depth()];
}

std::uint32_t BigEndian(const std::string& bytes, std::size_t at) {
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
bool IsWholeIfPng(const std::string& bytes) {
  const std::string signature = "\x89PNG\r\n\x1a\n";
  if (bytes.compare(0, 8, signature) != 0) return true;
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

int TypeOf(PixelFormat format) {
  switch (format) {
    case PixelFormat::kMono16:
      return CV_16UC1;
    case PixelFormat::kBgr8:
      return CV_8UC3;
    case PixelFormat::kJpeg:
    case PixelFormat::kPng:
      return -1;
    default:
      return CV_8UC1;
  }
}

[[noreturn]] void Refuse(const cv::Mat& pixels, const std::string& format,
                         const std::string& bits) {
  throw InputError("cannot write a " + format + " of a " + std::to_string(pixels.cols) + "x" +
                   std::to_string(pixels.rows) + " image of OpenCV type " +
                   std::to_string(pixels.type()) + "; expected " + bits + " with 1 or 3 channels");
}

std::string Encode(const std::string& extension, const cv::Mat& pixels,
                   const std::vector<int>& options) {
  std::vector<unsigned char> bytes;
  if (!cv::imencode(extension, pixels, bytes, options)) {
    throw InputError("OpenCV could not encode the image as " + extension);
  }
  return {bytes.begin(), bytes.end()};
}

}  // namespace

cv::Mat DecodeImageFile(const std::filesystem::path& path) {
  return DecodeImage(ReadWholeFile(path), path.string());
}

cv::Mat DecodeImage(const std::string& bytes, const std::string& where) {
  if (bytes.empty()) throw InputError(where + " is empty; expected an image");
  cv::Mat image;
  std::string reason = "damaged, cut short or of an unknown format";
  try {
    if (IsWholeIfPng(bytes)) {
      const cv::Mat view(1, static_cast<int>(bytes.size()), CV_8UC1,
                         const_cast<char*>(bytes.data()));
      image = cv::imdecode(view, cv::IMREAD_UNCHANGED);
    }
  } catch (const std::exception& error) {  // cv::Exception or bad_alloc (a forged size)
    reason = error.what();
  }
  if (image.empty()) throw InputError(where + " cannot be decoded as an image: " + reason);
  return image;
}

std::string EncodePng(const cv::Mat& pixels, int compression) {
  const int depth = pixels.depth();
  const int channels = pixels.channels();
  if (pixels.empty() || (depth != CV_8U && depth != CV_16U) || (channels != 1 && channels != 3)) {
    Refuse(pixels, "PNG", "8 or 16 bit");
  }
  return Encode(".png", pixels, {cv::IMWRITE_PNG_COMPRESSION, compression});
}

std::string EncodeJpeg(const cv::Mat& pixels, int quality) {
  if (pixels.empty() || (pixels.type() != CV_8UC1 && pixels.type() != CV_8UC3)) {
    Refuse(pixels, "JPEG", "8 bit");
  }
  return Encode(".jpg", pixels, {cv::IMWRITE_JPEG_QUALITY, quality});
}

void WritePng(const std::filesystem::path& path, const cv::Mat& pixels) {
  WriteFileAtomically(path, EncodePng(pixels));
}

PixelFormat FormatOf(PixelFormat told, cv::Mat* decoded) {
  if (decoded->type() == CV_8UC4) {
    cv::Mat bgr;
    cv::cvtColor(*decoded, bgr, cv::COLOR_BGRA2BGR);
    *decoded = bgr;
  }
  if (told != PixelFormat{}) {
    if (TypeOf(told) == decoded->type()) return told;
    throw InputError("is a " + Describe(*decoded) + " image, which is not " + NameOf(told));
  }
  for (const PixelFormat format : {PixelFormat::kMono8, PixelFormat::kMono16, PixelFormat::kBgr8}) {
    if (TypeOf(format) == decoded->type()) return format;
  }
  throw InputError("is a " + Describe(*decoded) +
                   " image; expected 8-bit grey, Bayer mosaic or colour, or 16-bit grey");
}

std::string NameOf(PixelFormat format) {
  switch (format) {
    case PixelFormat::kMono8:
      return "MONO8";
    case PixelFormat::kMono16:
      return "MONO16";
    case PixelFormat::kBayerRg8:
      return "BAYER_RG8";
    case PixelFormat::kBayerGr8:
      return "BAYER_GR8";
    case PixelFormat::kBayerGb8:
      return "BAYER_GB8";
    case PixelFormat::kBayerBg8:
      return "BAYER_BG8";
    case PixelFormat::kBgr8:
      return "BGR8";
    case PixelFormat::kJpeg:
      return "JPEG";
    case PixelFormat::kPng:
      return "PNG";
  }
  return "pixel format " + std::to_string(static_cast<int>(format));
}

}  // namespace rgbdt
