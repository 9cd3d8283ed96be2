#pragma once

#include <Eigen/Core>

#include "calib/simulate/lidar_options.h"

namespace rgbdt::simulate {

/// What holds the board up.
enum class Holder {
  kStand,   ///< a pole, hidden behind the board but for what shows under it
  kPerson,  ///< hands grip the border at two opposite sides, the body stands close behind
  kEasel,   ///< a ledge and legs flush with the board's front continue it below
};

/// Things that look like the board, off unless switched on. They stand in the field of view where
/// nothing else is, each in full view of the LIDAR; where is drawn from the seed. Sizes in metres.
struct ClutterOptions {
  bool door = false;          ///< a wall with a leaf slightly ajar
  bool poster = false;        ///< flush on a wall: differs in reflectivity only
  bool table = false;         ///< a level top on four legs
  bool panel = false;         ///< a whiteboard about as large as the board, on a pole
  bool second_board = false;  ///< the same as the first, on a stand of its own
  Holder holder = Holder::kStand;

  Eigen::Vector2d door_m{0.9, 2.0}, poster_m{1.0, 0.7}, panel_m{1.3, 1.0};  ///< width, height
  Eigen::Vector2d table_m{1.2, 0.8};  ///< width across the line of sight, depth
  double table_height_m = 0.75;       ///< of its top above the ground
  double door_ajar_rad = 15 * kDegree;
  double near_m = 2.5, far_m = 8;  ///< range of what is placed
  double min_azimuth_rad = 8 * kDegree, max_azimuth_rad = 28 * kDegree;  ///< to either side

  bool any() const { return door || poster || table || panel || second_board; }
  /// Throws InputError naming the field and its value.
  void Check() const;
};

}  // namespace rgbdt::simulate
