#pragma once

#include <cstdint>
#include <functional>

#include "calib/simulate/lidar_options.h"
#include "tests/study/cloud_scenes.h"

namespace rgbdt::study {

/// Clouds of a Livox, of a second each: the board 3 to 8 m away, at any roll, wholly in the field,
/// in the three scenes in turn; every second one with a thing that looks like a board.
void RenderLivoxClouds(simulate::LivoxModel model, int count, std::uint64_t seed,
                       const std::function<void(int, const CloudScene&)>& take);

}  // namespace rgbdt::study
