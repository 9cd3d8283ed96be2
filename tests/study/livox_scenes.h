#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "calib/model/calibration.h"
#include "calib/simulate/lidar_options.h"
#include "tests/study/cloud_scenes.h"

namespace rgbdt::study {

/// Clouds of a Livox, of a second each: the board 3 to 8 m away, at any roll, wholly in the field,
/// in the three scenes in turn; every second one with a thing that looks like a board, or that
/// holds it: a door, a poster, a table, a panel, a person, an easel.
void RenderLivoxClouds(simulate::LivoxModel model, int count, std::uint64_t seed,
                       const std::function<void(int, const CloudScene&)>& take);

struct LivoxSession {
  Rig rig;
  Truth truth;
  std::vector<ViewDetection> detections;  ///< one a view
};

/// A session of the simulator's rig with a Livox: clouds are rendered, corners sampled as
/// SampledEdges does; the board in the clouds is found by the library. Nothing where this seed's
/// scene has no room for so many views. Throws InputError where the board is not found.
std::optional<LivoxSession> MakeLivoxSession(simulate::LivoxModel model, int views,
                                             std::uint64_t seed);

}  // namespace rgbdt::study
