#include "calib/fuse/sightings.h"

#include <array>
#include <cstring>

namespace rgbdt {
namespace {

// Where in the image a pixel lies: its upper left neighbour and the shares of the others.
struct Place {
  int x, y;
  float right, below;

  Place(float u, float v, int columns, int rows) : x(static_cast<int>(u)), y(static_cast<int>(v)) {
    x = x < columns - 2 ? x : columns - 2;
    y = y < rows - 2 ? y : rows - 2;
    right = u - static_cast<float>(x);
    below = v - static_cast<float>(y);
  }
};

// Four floats that the compiler keeps in one register.
using Four = float __attribute__((vector_size(16)));

// Blue, green and red of the pixel whose bytes begin here, and one value more. `ahead`: take the
// pixel from bytes that begin one before it, so that the last of an image is not read beyond.
Four PixelAt(const std::uint8_t* bytes, int ahead) {
  std::uint32_t word = 0;
  std::memcpy(&word, bytes - ahead, sizeof word);
  word >>= 8 * ahead;
  return Four{static_cast<float>(word & 255U), static_cast<float>(word >> 8 & 255U),
              static_cast<float>(word >> 16 & 255U), 0};
}

std::uint32_t ColourAt(const cv::Mat& image, const Place& place) {
  const auto* top = image.ptr<std::uint8_t>(place.y) + 3 * static_cast<std::ptrdiff_t>(place.x);
  const std::uint8_t* bottom = top + image.step[0];
  const Four upper_left = PixelAt(top, 0);
  const Four lower_left = PixelAt(bottom, 0);
  const Four upper = upper_left + place.right * (PixelAt(top + 3, 1) - upper_left);
  const Four lower = lower_left + place.right * (PixelAt(bottom + 3, 1) - lower_left);
  const Four value = upper + place.below * (lower - upper) + 0.5F;
  // A black that was seen is 1, 1, 1: 0 says that no colour camera saw the point.
  const auto whole = [](float v) { return static_cast<std::uint32_t>(v < 1 ? 1.0F : v); };
  return whole(value[2]) | whole(value[1]) << 8 | whole(value[0]) << 16;
}

std::uint32_t CountsAt(const cv::Mat& image, const Place& place) {
  const float* top = image.ptr<float>(place.y) + place.x;
  const float* bottom = image.ptr<float>(place.y + 1) + place.x;
  const float upper = top[0] + place.right * (top[1] - top[0]);
  const float lower = bottom[0] + place.right * (bottom[1] - bottom[0]);
  const float counts = upper + place.below * (lower - upper);
  std::uint32_t sample = 0;
  std::memcpy(&sample, &counts, sizeof sample);
  return sample;
}

}  // namespace

void Sightings::Clear() {
  point.clear();
  u.clear();
  v.clear();
  inverse_range.clear();
  sample.clear();
  hidden.clear();
  runs.clear();
}

void Sightings::Append(const Sightings& other, std::size_t first_point) {
  const std::size_t before = size();
  for (const std::uint32_t p : other.point) {
    point.push_back(p + static_cast<std::uint32_t>(first_point));
  }
  const auto append = [](const auto& from, auto* to) {
    to->insert(to->end(), from.begin(), from.end());
  };
  append(other.u, &u);
  append(other.v, &v);
  append(other.inverse_range, &inverse_range);
  append(other.sample, &sample);
  append(other.hidden, &hidden);
  for (const Run& run : other.runs) {
    if (!runs.empty() && runs.back().temperatures == run.temperatures) {
      runs.back().end = before + run.end;
    } else {
      runs.push_back({before + run.end, run.temperatures});
    }
  }
}

void SampleImage(const FusionCamera& camera, const PreparedImage& image, const PixelBlock& block,
                 std::size_t first_point, std::size_t count, Sightings* sightings) {
  const cv::Mat& pixels = image.pixels;
  const bool thermal = camera.spec().kind == CameraKind::kThermal;
  const auto most_u = static_cast<float>(pixels.cols - 1);
  const auto most_v = static_cast<float>(pixels.rows - 1);
  std::array<std::uint32_t, PixelBlock::kSize> inside;
  std::size_t found = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const float u = block.u[i];
    const float v = block.v[i];
    inside[found] = static_cast<std::uint32_t>(i);
    found += static_cast<std::size_t>((block.inverse_range[i] > 0) & (u >= 0) & (v >= 0) &
                                      (u <= most_u) & (v <= most_v));
  }
  const std::size_t begin = sightings->size();
  const std::size_t end = begin + found;
  sightings->point.resize(end);
  sightings->u.resize(end);
  sightings->v.resize(end);
  sightings->inverse_range.resize(end);
  sightings->sample.resize(end);
  sightings->hidden.resize(end, 0);
  for (std::size_t k = 0; k < found; ++k) {
    const std::uint32_t i = inside[k];
    sightings->point[begin + k] = static_cast<std::uint32_t>(first_point) + i;
    sightings->u[begin + k] = block.u[i];
    sightings->v[begin + k] = block.v[i];
    sightings->inverse_range[begin + k] = block.inverse_range[i];
    const Place place(block.u[i], block.v[i], pixels.cols, pixels.rows);
    sightings->sample[begin + k] = thermal ? CountsAt(pixels, place) : ColourAt(pixels, place);
  }
  if (!sightings->runs.empty() && sightings->runs.back().temperatures == image.temperatures) {
    sightings->runs.back().end = end;
  } else {
    sightings->runs.push_back({end, image.temperatures});
  }
}

void Judge(const DepthBuffer& now, const DepthBuffer* past, std::size_t first,
           Sightings* sightings) {
  for (std::size_t i = first; i < sightings->size(); ++i) {
    const float u = sightings->u[i];
    const float v = sightings->v[i];
    const float w = sightings->inverse_range[i];
    sightings->hidden[i] =
        static_cast<std::uint8_t>(now.Hides(u, v, w) || (past != nullptr && past->Hides(u, v, w)));
  }
}

float CountsOf(std::uint32_t sample) {
  float counts = 0;
  std::memcpy(&counts, &sample, sizeof counts);
  return counts;
}

}  // namespace rgbdt
