#pragma once

#include "calib/simulate/lidar_options.h"

namespace rgbdt::simulate {

/// Scenes as they are found, each seed another: a street (Scene::kOutdoor) or a furnished room
/// (Scene::kIndoor). The rig stands still within a view and drives on between views.
struct NaturalOptions {
  bool on = false;
  bool board = false;             ///< whether the board stands in the scene, too
  double step_m = 0.5;            ///< the rig's way from view to view; 0: it stays where it is
  double turn_rad = 5 * kDegree;  ///< about what its heading changes by from view to view
  int people = 4;                 ///< who walk: each view at another place and in another stance
  double leaves = 1;              ///< how dense foliage is: number of leaves, times the usual

  /// Throws InputError naming the field and its value.
  void Check() const;
};

}  // namespace rgbdt::simulate
