#pragma once

#include "calib/simulate/internal/scene.h"
#include "calib/simulate/options.h"

namespace rgbdt::simulate {

/// The natural scene of a view, in the LIDAR frame as the rig stands in that view: a function of
/// (seed, index).
SceneModel MakeNaturalScene(const Options& options, int index);

/// The same in the world's frame, for a rig that drives there, about so far along the street, and
/// without people.
SceneModel MakeNaturalWorld(const Options& options, double x_m);

}  // namespace rgbdt::simulate
