#pragma once

#include "calib/simulate/internal/world.h"

namespace rgbdt::simulate {

/// The paper's hard case: part of the outline cannot be seen in the thermal image because what lies
/// behind it is as warm. Looks from a thermal camera's centre (LIDAR frame) past the board's
/// border and takes the stretch, `hidden_outline_m` long, whose background is nearest to the
/// border's temperature; there the board takes on the background's. Where nothing but sky or very
/// uneven things lie behind, the heat stays as it is.
HeatMap HideOutline(const World& world, const Eigen::Vector3d& camera_centre,
                    const BoardOptions& options);

}  // namespace rgbdt::simulate
