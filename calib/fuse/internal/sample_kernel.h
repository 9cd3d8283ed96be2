#pragma once

// Inside calib/fuse only: the loops of point_samples.h over points that lie in an image.

#include <cstddef>
#include <cstdint>

namespace rgbdt {

/// An image's pixels: 3 bytes blue, green, red each, or a float.
struct ImageRows {
  const std::uint8_t* pixels;
  std::size_t step;  ///< bytes from a row to the next
  int columns, rows;
};

inline constexpr std::size_t kSampleBlock = 512;  ///< points at a time, at most

/// Bilinear samples at pixels (u, v) of the image: red | green << 8 | blue << 16, 1 to 255 each.
void SampleColours(const ImageRows& image, const float* u, const float* v, std::size_t count,
                   std::uint32_t* samples);

/// The same of an image of floats.
void SampleFloats(const ImageRows& image, const float* u, const float* v, std::size_t count,
                  float* samples);

}  // namespace rgbdt
