#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <optional>

#include "calib/camera/camera.h"
#include "calib/model/rig.h"
#include "calib/model/rigid3.h"

namespace rgbdt {

/// Where a place on the board (x and y of the target frame [m]) is seen [px], through the lens;
/// nothing where it cannot be.
using BoardMap = std::function<std::optional<Eigen::Vector2d>(const Eigen::Vector2d&)>;

/// From the board's pose. `camera` must outlive the map.
BoardMap MapByPose(const Camera& camera, const Rigid3& camera_from_target);

/// From where the outline's four corners are seen [px], in the target's order: top left, top right,
/// bottom right, bottom left. Nothing where they cannot be a board's, or a quarter turn off the
/// camera's axis. `camera` must outlive the map.
std::optional<BoardMap> MapByOutline(const Camera& camera, const Target& target,
                                     const std::array<Eigen::Vector2d, 4>& outline);

/// A place in an image and the grid round it, as FitCorner takes them.
struct GridPlace {
  Eigen::Vector2d place{0, 0};                      ///< [px]
  Eigen::Matrix2d steps = Eigen::Matrix2d::Zero();  ///< see GridModel::Steps
  Eigen::Matrix2d bends = Eigen::Matrix2d::Zero();  ///< see GridModel::Bends
  double spacing() const { return steps.colwise().norm().minCoeff(); }
};

/// The grid of squares of `square_m` at a place on the board; nothing where it cannot be seen.
std::optional<GridPlace> GridAt(const BoardMap& map, const Eigen::Vector2d& on_board,
                                double square_m);

}  // namespace rgbdt
