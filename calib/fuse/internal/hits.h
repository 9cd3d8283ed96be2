#pragma once

#include "calib/model/cloud.h"
#include "calib/model/rgbdt_cloud.h"

namespace rgbdt {

/// Adds the chunk's points that returned, with intensities (NaN where the chunk has none) and times
/// (where it has none, its sweep's).
void AppendHits(const Cloud& chunk, RgbdtCloud* hits);

}  // namespace rgbdt
