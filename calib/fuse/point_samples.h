#pragma once

#include <cstdint>
#include <cstring>
#include <memory>
#include <vector>

#include "calib/camera/project_points.h"
#include "calib/fuse/depth_buffer.h"
#include "calib/fuse/fusion_camera.h"

namespace rgbdt {

/// Those points of a cloud that project into one camera's image, occluded or not, and what the
/// image shows there.
struct PointSamples {
  std::vector<std::uint32_t> point;  ///< which of the cloud's points, rising
  std::vector<float> u, v;           ///< [px]
  std::vector<float> inverse_range;  ///< from the camera's centre [1/m]
  /// Of a colour camera red | green << 8 | blue << 16; of a thermal one the bits of a float,
  /// counts.
  std::vector<std::uint32_t> sample;
  std::vector<std::uint8_t> occluded;  ///< 1: it is; as far as TestOcclusion() went
  /// Samples from `first` on, and before the next run, are of images with this radiometry.
  struct Run {
    std::size_t first = 0;
    std::shared_ptr<const TemperatureTable> temperatures;
  };
  std::vector<Run> runs;

  std::size_t size() const { return point.size(); }
  /// The first sample, from `begin` on, of this point or a later one; size(): none.
  std::size_t FirstFrom(std::size_t point_number, std::size_t begin = 0) const;
  void Clear() { CutBack(0); }
  /// To the first `size`.
  void CutBack(std::size_t size);
};

/// Adds the block's points that lie in the image, sampled bilinearly; goes on with a run.
/// `first_point`: the number of the block's first one.
void SampleImage(const FusionCamera& camera, const PreparedImage& image, const PixelBlock& block,
                 std::size_t first_point, std::size_t count, PointSamples* samples);

/// Fills in which of samples [first, size()) are occluded by `now`, or by `past` if there is one.
void TestOcclusion(const DepthBuffer& now, const DepthBuffer* past, std::size_t first,
                   PointSamples* samples);

/// A thermal sample's counts.
inline float CountsOf(std::uint32_t sample) {
  float counts = 0;
  std::memcpy(&counts, &sample, sizeof counts);
  return counts;
}

}  // namespace rgbdt
