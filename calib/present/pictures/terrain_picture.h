#pragma once

#include <opencv2/core/mat.hpp>
#include <string>

#include "calib/terrain/terrain.h"

namespace rgbdt {

/// The terrain from above (8-bit BGR), x to the right, y up, metres along the axes: traversable
/// cells green, the darker the steeper, obstacles red, unknown grey; landing sites as numbered
/// circles. Beside it the temperature [C] where any is known. Cut to the cells whose state is
/// known. The same terrain gives the same picture.
cv::Mat TerrainPicture(const Terrain& terrain, const TerrainOptions& options,
                       const std::string& frame);

}  // namespace rgbdt
