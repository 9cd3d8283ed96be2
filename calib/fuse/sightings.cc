#include "calib/fuse/sightings.h"

#include <algorithm>
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

std::uint32_t ColourAt(const cv::Mat& image, const Place& place) {
  const auto* top = image.ptr<std::uint8_t>(place.y) + 3 * static_cast<std::ptrdiff_t>(place.x);
  const std::uint8_t* bottom = top + image.step[0];
  const float a = (1 - place.right) * (1 - place.below);
  const float b = place.right * (1 - place.below);
  const float c = (1 - place.right) * place.below;
  const float d = place.right * place.below;
  std::uint32_t sample = 0;
  for (int channel = 0; channel < 3; ++channel) {
    const float value = a * top[channel] + b * top[channel + 3] + c * bottom[channel] +
                        d * bottom[channel + 3] + 0.5F;
    // A black that was seen is 1, 1, 1: 0 says that no colour camera saw the point.
    const auto whole = static_cast<std::uint32_t>(value < 1 ? 1.0F : value);
    sample |= whole << (16 - 8 * channel);  // images are blue, green, red
  }
  return sample;
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
  pixels.Resize(0);
  samples.clear();
  hidden.clear();
  runs.clear();
}

void Sightings::Append(const Sightings& other) {
  const std::size_t before = size();
  const auto append = [](const auto& from, auto* to) {
    to->insert(to->end(), from.begin(), from.end());
  };
  append(other.pixels.u, &pixels.u);
  append(other.pixels.v, &pixels.v);
  append(other.pixels.inverse_range, &pixels.inverse_range);
  append(other.samples, &samples);
  append(other.hidden, &hidden);
  for (const Run& run : other.runs) {
    if (!runs.empty() && runs.back().temperatures == run.temperatures) {
      runs.back().end = before + run.end;
    } else {
      runs.push_back({before + run.end, run.temperatures});
    }
  }
}

void SampleImage(const FusionCamera& camera, const PreparedImage& image, std::size_t first,
                 std::size_t end, Sightings* sightings) {
  const cv::Mat& pixels = image.pixels;
  const bool thermal = camera.spec().kind == CameraKind::kThermal;
  const auto most_u = static_cast<float>(pixels.cols - 1);
  const auto most_v = static_cast<float>(pixels.rows - 1);
  const PixelColumns& at = sightings->pixels;
  sightings->samples.resize(end, Sightings::kUnseen);
  for (std::size_t i = first; i < end; ++i) {
    const float u = at.u[i];
    const float v = at.v[i];
    if (!(at.inverse_range[i] > 0 && u >= 0 && v >= 0 && u <= most_u && v <= most_v)) continue;
    const Place place(u, v, pixels.cols, pixels.rows);
    sightings->samples[i] = thermal ? CountsAt(pixels, place) : ColourAt(pixels, place);
  }
  sightings->runs.push_back({end, image.temperatures});
}

void SampleNothing(std::size_t end, Sightings* sightings) {
  sightings->samples.resize(end, Sightings::kUnseen);
  sightings->runs.push_back({end, nullptr});
}

void Judge(const DepthBuffer& now, const DepthBuffer* past, std::size_t first, std::size_t end,
           Sightings* sightings) {
  const PixelColumns& at = sightings->pixels;
  sightings->hidden.resize(std::max(end, sightings->hidden.size()), 0);
  for (std::size_t i = first; i < end; ++i) {
    if (sightings->samples[i] == Sightings::kUnseen) continue;
    const float u = at.u[i];
    const float v = at.v[i];
    const float w = at.inverse_range[i];
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
