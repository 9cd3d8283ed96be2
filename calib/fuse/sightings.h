#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "calib/camera/project_points.h"
#include "calib/fuse/depth_buffer.h"
#include "calib/fuse/fusion_camera.h"

namespace rgbdt {

/// What one camera's images show where the points of a cloud lie in them, hidden or not: by point.
struct Sightings {
  static constexpr std::uint32_t kUnseen = 0xFFFFFFFF;  ///< outside of the image; a NaN as a float

  PixelColumns pixels;
  /// Of a colour camera red | green << 8 | blue << 16; of a thermal one the bits of a float,
  /// counts.
  std::vector<std::uint32_t> samples;
  std::vector<std::uint8_t> hidden;  ///< 1: something is in the way; Judge()
  /// Points before `end`, and after the run before, were sampled from one image.
  struct Run {
    std::size_t end = 0;
    std::shared_ptr<const TemperatureTable> temperatures;
  };
  std::vector<Run> runs;

  std::size_t size() const { return samples.size(); }
  void Clear();
  /// Goes on with another's points.
  void Append(const Sightings& other);
};

/// Samples points [first, end) of `sightings->pixels` in an image, bilinearly; goes on with a run.
void SampleImage(const FusionCamera& camera, const PreparedImage& image, std::size_t first,
                 std::size_t end, Sightings* sightings);

/// The same where no image serves: none of the points is seen.
void SampleNothing(std::size_t end, Sightings* sightings);

/// Fills in which of points [first, end) are hidden by `now`, or by `past` if there is one.
void Judge(const DepthBuffer& now, const DepthBuffer* past, std::size_t first, std::size_t end,
           Sightings* sightings);

/// A thermal sample's counts; NaN where unseen.
float CountsOf(std::uint32_t sample);

}  // namespace rgbdt
