#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "calib/fuse/depth_buffer.h"
#include "calib/fuse/point_samples.h"

namespace rgbdt {

/// What one camera of the rig brings in.
struct BlendCamera {
  const FusionCamera* camera = nullptr;
  const PointSamples* samples = nullptr;
  const DepthBuffer* surfaces = nullptr;  ///< how squarely the camera looks at them; null: unknown
};

/// What the cameras tell of points, in the terms of RgbdtCloud. All vectors are equally long.
struct Blended {
  std::vector<std::array<std::uint8_t, 3>> rgb;
  std::vector<float> temperature_k, temperature_sigma_k, thermal_counts;
  std::vector<std::uint32_t> valid;
  std::int64_t coloured = 0;  ///< points that at least one camera saw
  std::int64_t occluded = 0;  ///< by camera: points that lie in its image, but behind something
};

/// Of points [first, first + size) of those that the samples number. Of several cameras of a kind
/// that see a point, each counts by how squarely and how far from its border it looks, little where
/// it is saturated; temperatures also by their sigmas. Counts are those of the camera that counts
/// most.
Blended Blend(const std::vector<BlendCamera>& cameras, std::size_t first, std::size_t size);

}  // namespace rgbdt
