#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/simulate/internal/scene.h"
#include "calib/simulate/options.h"

namespace rgbdt::simulate {

/// A thing that looks like the board, in a frame that stands on the ground: x away from the LIDAR,
/// y left, z up. `seen` are places that the LIDAR must see.
struct ClutterThing {
  std::string name;
  std::vector<SceneObject> parts;
  std::vector<Eigen::Vector3d> seen;
};

ClutterThing MakeDoor(const ClutterOptions& options);
ClutterThing MakePoster(const ClutterOptions& options);
ClutterThing MakeTable(const ClutterOptions& options);
ClutterThing MakePanel(const ClutterOptions& options);

/// Adds what options.clutter ask for. Throws InputError where the scene has no room for it.
void AddClutter(const Options& options, SceneModel* scene);

}  // namespace rgbdt::simulate
