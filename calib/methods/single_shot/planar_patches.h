#pragma once

#include <vector>

#include "calib/model/cloud.h"
#include "calib/model/rig.h"
#include "calib/model/view_detection.h"

namespace rgbdt {

// The paper grows segments over normals of each point's neighbours and drops those much smaller or
// larger than a board. Here regions grow as for the detection of boards (plane_regions.h); the
// sizes kept are ours. A piece's centre is that of the smallest rectangle about it.

struct PatchOptions {
  double range_sigma_m = 0.01;
  double least_size = 0.6;  ///< of the board's width and height
  double most_size = 1.5;
  std::size_t most_patches = 20;  ///< those nearest to the board's size

  /// Throws InputError naming the field and its value.
  void Check() const;
};

/// The pieces of a cloud that are plane and about as large as the target, nearest in size first, as
/// candidates without a pose: centre and normal, extent, points and their scatter (the same raw and
/// not), the hull as `boundary`.
std::vector<CloudEdges> PlanarPatches(const Cloud& cloud, const Target& target,
                                      const PatchOptions& options = {});

}  // namespace rgbdt
