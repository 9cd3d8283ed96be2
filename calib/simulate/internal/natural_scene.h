#pragma once

#include "calib/simulate/internal/scene.h"
#include "calib/simulate/options.h"

namespace rgbdt::simulate {

/// The natural scene of a view, in the LIDAR frame as the rig stands in that view: a function of
/// (seed, index).
SceneModel MakeNaturalScene(const Options& options, int index);

}  // namespace rgbdt::simulate
