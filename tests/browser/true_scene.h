#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "calib/model/calibration.h"
#include "calib/simulate/internal/world.h"
#include "calib/simulate/options.h"

namespace rgbdt::browser {

/// Temperatures [K] of the surfaces that a pixel may show.
struct Temperatures {
  double low = 0, high = 0;
};

/// What a point of the cloud truly is.
struct TruePoint {
  double distance_m = 0;               ///< from the point to where its beam meets the scene
  std::string what;                    ///< "board", or the object's name
  std::optional<Temperatures> kelvin;  ///< absent: the beam meets nothing
};

/// A simulator's scene in one of its views, made again from its seed and its truth file, without
/// rendering an image and without anything of the fuser.
class TrueScene {
 public:
  /// `view`: "0001" is the simulator's first. Throws InputError where the truth lacks it.
  TrueScene(const simulate::Options& options, const std::filesystem::path& truth,
            const std::string& view);

  /// Middles of nine squares spread over the board, LIDAR frame [m].
  std::vector<Eigen::Vector3d> Squares() const;
  /// The middle of the board, LIDAR frame [m].
  const Eigen::Vector3d& BoardCentre() const { return lidar_from_target_.translation; }
  /// The board's outline in a camera's image [px]: top left, top right, bottom right, bottom left.
  std::array<Eigen::Vector2d, 4> OutlineIn(const std::string& camera) const;
  /// Of a point that the turned scanner measured, LIDAR frame [m].
  TruePoint At(const Eigen::Vector3d& point) const;

 private:
  Temperatures SeenAround(const Eigen::Vector3d& place) const;

  simulate::Options options_;
  Truth truth_;
  Rigid3 lidar_from_target_;
  std::optional<simulate::World> world_;
};

}  // namespace rgbdt::browser
