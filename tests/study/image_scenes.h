#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "calib/model/image.h"
#include "calib/model/rig.h"
#include "calib/simulate/options.h"

namespace rgbdt::study {

/// A kind of scene: what is hard about it.
struct SceneClass {
  std::string name;
  CameraKind kind = CameraKind::kThermal;
  simulate::Scene scene = simulate::Scene::kOutdoor;
  bool inverted = false, glow = false, border = false, hands = false, dead = false;
};

/// Colour in three scenes, thermal in three scenes, with each hard term and with all of them.
std::vector<SceneClass> SceneClasses();

/// One rendered image with its truth.
struct ImageScene {
  Image image;
  Target target;
  std::vector<Eigen::Vector2d> corners;  ///< true inner corners, the target's order [px]
  double range_m = 0;                    ///< of the board's centre
  double contrast_k = 0;                 ///< thermal: between black and white squares
};

/// The simulator's options for scene `index` of a class: contrast and hard terms are drawn.
simulate::Options SceneOptions(const SceneClass& scene_class, int index, std::uint64_t seed);

/// Renders scenes 0 ... count - 1 of a class and hands each over.
void RenderScenes(const SceneClass& scene_class, int count, std::uint64_t seed,
                  const std::function<void(int, const ImageScene&)>& take);

}  // namespace rgbdt::study
