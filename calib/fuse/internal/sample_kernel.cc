#include "calib/fuse/internal/sample_kernel.h"

#include <cstring>

#include "calib/camera/simd_dispatch.h"

namespace rgbdt {
namespace {

// Where in the image a pixel lies: bytes to its upper left neighbour, and the shares of the others.
struct Place {
  std::int32_t offset;
  float right, below;
};

template <int kPixelBytes>
inline Place PlaceOf(const ImageRows& image, float u, float v) {
  auto x = static_cast<std::int32_t>(u);
  auto y = static_cast<std::int32_t>(v);
  x = x < image.columns - 2 ? x : image.columns - 2;
  y = y < image.rows - 2 ? y : image.rows - 2;
  return {y * static_cast<std::int32_t>(image.step) + x * kPixelBytes, u - static_cast<float>(x),
          v - static_cast<float>(y)};
}

// Between four neighbours.
inline float Between(const Place& place, float upper_left, float upper_right, float lower_left,
                     float lower_right) {
  const float upper = upper_left + place.right * (upper_right - upper_left);
  const float lower = lower_left + place.right * (lower_right - lower_left);
  return upper + place.below * (lower - upper);
}

template <typename T>
inline T At(const std::uint8_t* bytes, std::int32_t offset) {
  T value;
  std::memcpy(&value, bytes + offset, sizeof value);
  return value;
}

inline float Byte(std::uint32_t word, int number) {
  return static_cast<float>(static_cast<std::int32_t>(word >> (8 * number) & 255U));
}

}  // namespace

// In steps, as what is fetched from anywhere is best fetched at once: the processor waits for many.
RGBDT_SIMD_DISPATCH
void SampleColours(const ImageRows& image, const float* u, const float* v, std::size_t count,
                   std::uint32_t* samples) {
  const ImageRows im = image;
  const std::uint8_t* lower_row = im.pixels + im.step;
  std::int32_t offset[kSampleBlock];
  for (std::size_t i = 0; i < count; ++i) offset[i] = PlaceOf<3>(im, u[i], v[i]).offset;
  // Four bytes each, of which three count: of the left pixels the first, of the right ones the
  // last, so that the last pixel of an image is not read beyond.
  struct {
    std::uint32_t upper_left, upper_right, lower_left, lower_right;
  } pixels[kSampleBlock];
  for (std::size_t i = 0; i < count; ++i) {
    pixels[i].upper_left = At<std::uint32_t>(im.pixels, offset[i]);
    pixels[i].upper_right = At<std::uint32_t>(im.pixels, offset[i] + 2);
    pixels[i].lower_left = At<std::uint32_t>(lower_row, offset[i]);
    pixels[i].lower_right = At<std::uint32_t>(lower_row, offset[i] + 2);
  }
  for (std::size_t i = 0; i < count; ++i) {
    const Place place = PlaceOf<3>(im, u[i], v[i]);
    const auto& p = pixels[i];
    std::uint32_t sample = 0;
    for (int c = 0; c < 3; ++c) {
      const float value = 0.5F + Between(place, Byte(p.upper_left, c), Byte(p.upper_right, c + 1),
                                         Byte(p.lower_left, c), Byte(p.lower_right, c + 1));
      // A black that was seen is 1, 1, 1: 0 says that no colour camera saw the point.
      sample |= static_cast<std::uint32_t>(static_cast<std::int32_t>(value < 1 ? 1 : value))
                << (16 - 8 * c);
    }
    samples[i] = sample;
  }
}

RGBDT_SIMD_DISPATCH
void SampleFloats(const ImageRows& image, const float* u, const float* v, std::size_t count,
                  float* samples) {
  const ImageRows im = image;
  const std::uint8_t* lower_row = im.pixels + im.step;
  RGBDT_INDEPENDENT
  for (std::size_t i = 0; i < count; ++i) {
    const Place place = PlaceOf<4>(im, u[i], v[i]);
    samples[i] =
        Between(place, At<float>(im.pixels, place.offset), At<float>(im.pixels, place.offset + 4),
                At<float>(lower_row, place.offset), At<float>(lower_row, place.offset + 4));
  }
}

}  // namespace rgbdt
