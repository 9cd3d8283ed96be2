#pragma once

#include <vector>

#include "calib/detect/cloud/range_grid.h"
#include "calib/methods/natural/scene_edge.h"

namespace rgbdt {

/// Where a sweep's intensity steps from one level to another on a surface that goes on evenly:
/// paint, frames, posters, signs, tiles. In both directions of the scan; what two rows differ by
/// everywhere (rings are not equally sensitive) counts for nothing. The rim lies where the beams
/// between would put it that met both levels. Only those whose rim runs on over some beams
/// (rims.h). None where the cloud has no intensities.
std::vector<SceneEdge> FindReflectivityEdges(const RangeGrid& grid);

}  // namespace rgbdt
