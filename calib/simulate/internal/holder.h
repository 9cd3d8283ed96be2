#pragma once

#include <vector>

#include "calib/simulate/internal/board.h"
#include "calib/simulate/internal/scene.h"
#include "calib/simulate/options.h"

namespace rgbdt::simulate {

/// What holds the board as options.clutter.holder says, LIDAR frame. `air_k`: the stand's
/// temperature.
std::vector<SceneObject> MakeHolder(const Board& board, const Options& options, double air_k);

}  // namespace rgbdt::simulate
