#include "tests/bench/scanned_room.h"

#include <algorithm>
#include <cmath>

namespace rgbdt::bench {
namespace {

constexpr Utime kSweep = kMicrosecondsPerSecond / 10;

double RangeAt(double azimuth, double elevation) {
  const double wall = 7 + std::sin(3 * azimuth) + 0.3 * std::cos(9 * elevation);
  return std::sin(11 * azimuth) > 0.9 ? 0.6 * wall : wall;  // posts
}

}  // namespace

Cloud ScannedRoom(const Field& field, std::int64_t points, Utime utime) {
  Cloud cloud;
  cloud.sweep_utime = utime;
  cloud.beams = static_cast<int>(std::clamp<std::int64_t>(points / 1000, 128, 2000));
  cloud.lines = static_cast<int>(points / cloud.beams);
  const auto size = static_cast<std::size_t>(cloud.lines) * static_cast<std::size_t>(cloud.beams);
  cloud.points.reserve(size);
  for (int line = 0; line < cloud.lines; ++line) {
    const double azimuth = field.wide * ((line + 0.5) / cloud.lines - 0.5);
    for (int beam = 0; beam < cloud.beams; ++beam) {
      const double elevation = field.high * ((beam + 0.5) / cloud.beams - 0.5);
      const double range = RangeAt(azimuth, elevation);
      const Eigen::Vector3d direction(std::cos(elevation) * std::cos(azimuth),
                                      std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
      cloud.points.emplace_back((range * direction).cast<float>());
      cloud.utime.push_back(utime + kSweep * line / cloud.lines);
    }
  }
  cloud.intensity.assign(size, 0.5F);
  return cloud;
}

Image PictureOf(const CameraSpec& camera, Utime utime, int variant) {
  Image image;
  image.camera = camera.name;
  image.utime = utime;
  image.format = camera.format;
  image.radiometry = camera.radiometry;
  const bool wide = camera.format == PixelFormat::kMono16;
  image.pixels.create(camera.height, camera.width, wide ? CV_16UC1 : CV_8UC1);
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const int value = (x * 3 + y * 2 + variant * 31 + (x * y) % 17) % 200 + 20;
      if (wide) {
        image.pixels.at<std::uint16_t>(y, x) = static_cast<std::uint16_t>(3000 + 10 * value);
      } else {
        image.pixels.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(value);
      }
    }
  }
  return image;
}

}  // namespace rgbdt::bench
