#pragma once

#include <cstdint>
#include <vector>

#include "calib/fuse/depth_buffer.h"
#include "calib/fuse/sightings.h"
#include "calib/model/rgbdt_cloud.h"

namespace rgbdt {

/// What one camera of the rig brings in.
struct BlendCamera {
  const FusionCamera* camera = nullptr;
  const Sightings* sightings = nullptr;
  const DepthBuffer* surfaces = nullptr;  ///< how squarely the camera looks at them; null: unknown
};

struct BlendCounts {
  std::int64_t coloured = 0;  ///< points that at least one camera saw
  std::int64_t hidden = 0;    ///< points that lie in an image, but behind something
};

/// Fills colour, temperature, counts and `valid` of all of the cloud's points, which are points
/// [first, first + size) of those that the sightings number. Of several cameras of a kind that see
/// a point, each counts by how squarely and how far from its border it looks, little where it is
/// saturated; temperatures also by their sigmas. Counts are those of the camera that counts most.
BlendCounts Blend(const std::vector<BlendCamera>& cameras, std::size_t first, RgbdtCloud* fused);

}  // namespace rgbdt
