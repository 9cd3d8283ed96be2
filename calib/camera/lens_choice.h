#pragma once

#include "calib/camera/intrinsics.h"

namespace rgbdt {

/// Tries the other lens models on the corners that gave `result` and says which one the images
/// want: one that fits clearly better, by the information criterion, which takes a number more only
/// where it explains more than chance does, and by 5% or more of the RMS at least; or pinhole5 in
/// place of pinhole8 where the further numbers explain nothing.
LensComparison CompareLenses(const IntrinsicsInput& input, const IntrinsicsResult& result,
                             const IntrinsicsOptions& options = {});

}  // namespace rgbdt
