#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>

namespace rgbdt {

struct ImageSize {
  std::int64_t width, height;  // [px]
};

/// What a PNG, JPEG, TIFF, BMP or PNM says of itself, before it is unpacked, which may take a
/// thousand times its bytes; nothing for what is none of them.
std::optional<ImageSize> StatedSize(const void* bytes, std::size_t size);

/// Whether a JPEG's EXIF says that it is to be turned or mirrored before it is looked at, as
/// cameras write that were held so (tag 274, other than 1).
bool IsTurnedByExif(const void* bytes, std::size_t size);

/// The pixels of a PNG, JPEG, TIFF, BMP or PNM as they are stored: depth and channels unchanged, no
/// rotation by EXIF. Throws InputError, which begins with `where`, for bytes that cannot be
/// decoded, for a PNG that is cut short or damaged, and for an image of more than 2^27 pixels or of
/// more than `size` bytes can hold, which is not unpacked.
cv::Mat DecodeImage(const void* bytes, std::size_t size, const std::string& where);

}  // namespace rgbdt
