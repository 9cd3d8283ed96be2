#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "calib/simulate/internal/material.h"
#include "calib/simulate/internal/mesh.h"
#include "calib/simulate/options.h"

namespace rgbdt::simulate {

class Board;

/// A source of light. Colours are blue, green, red; 1 lights a white sheet to the fullest.
struct Light {
  enum class Kind { kSun, kPoint, kLamp };
  Kind kind = Kind::kSun;
  Eigen::Vector3d place{0, 0, 1};  ///< kSun: unit, towards it; otherwise where it hangs [m]
  Eigen::Vector3d color{1, 1, 1};  ///< at `reach_m`, falling off with the square of distance
  double reach_m = 1;              ///< not kSun
  bool casts_shadows = true;       ///< false: a wide, soft source
  /// kLamp: points along x; ends softly outside this cone and beyond this distance.
  double cone_rad = 0, end_m = 0;
};

struct Sky {
  Eigen::Vector3d zenith{0.9, 0.6, 0.4}, horizon{0.9, 0.85, 0.8};  ///< radiance, blue green red
  double cloud = 0;                                                ///< radiance that a cloud adds
  double zenith_k = 240, horizon_k = 265;                          ///< apparent temperature
};

struct SceneObject {
  std::string name;
  Mesh mesh;  ///< LIDAR frame
  Material material;
  std::shared_ptr<const Board> pattern = {};  ///< not null: the object is a board and looks like it
};

/// What the board takes on in a scene where the options do not say.
struct BoardHeat {
  double temperature_k = 300, black_minus_white_k = 5, gradient_k = 3, glow_k = 3;
};

/// Everything but board and stand: does not move. LIDAR frame, metres.
struct SceneModel {
  std::vector<SceneObject> objects;
  std::vector<Light> lights;
  Eigen::Vector3d ambient{0.3, 0.3, 0.3};  ///< light from all round, blue green red
  Sky sky;
  double reflected_temperature_k = 280;  ///< what surfaces mirror
  double air_k = 295;                    ///< what the stand takes on
  /// Towards the sun that has warmed what it shone on (unit): warmth stays a while in a place that
  /// has come to lie in the shadow.
  Eigen::Vector3d warming_sun{0, 0, 1};
  /// Radiance that exposure is set by, besides the board's; absent: by a white sheet ahead.
  std::optional<double> white;
  /// Pixels beside an edge, through which none runs, are rendered with fewer rays.
  bool many_edges = false;
  /// Where the rig stands; absent: at the world's origin. Textures and sky lie in the world.
  std::optional<Rigid3> world_from_lidar;
  BoardHeat board_heat;
};

/// Ground, wall, boxes, trees and a warm person; or a room. All of it lies farther from the LIDAR
/// than the board stands by default, but for the ground, what is beside the field of view, and
/// clutter. Of natural scenes: what the first view shows.
SceneModel MakeScene(const Options& options);

}  // namespace rgbdt::simulate
