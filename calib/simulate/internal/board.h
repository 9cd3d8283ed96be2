#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "calib/simulate/internal/marker_bits.h"
#include "calib/simulate/internal/material.h"
#include "calib/simulate/internal/mesh.h"
#include "calib/simulate/internal/scene.h"
#include "calib/simulate/options.h"

namespace rgbdt::simulate {

/// Temperature over the board [K]: `mean`, black above and white below it by half of
/// `black_minus_white`; a slope from end to end; a warm patch; and a stretch of the outline that is
/// as warm as what lies behind it. Places in the target frame.
struct HeatMap {
  double mean_k = 300, black_minus_white_k = 0;
  Eigen::Vector2d slope_k_per_m{0, 0};
  Eigen::Vector2d glow_centre{0, 0};
  double glow_k = 0, glow_radius_m = 1;
  bool hides = false;
  Eigen::Vector2d hidden_centre{0, 0}, hidden_along{1, 0};  ///< on the outline; unit, along it
  double hidden_half_m = 0, hidden_depth_m = 1, hidden_k = 0;
  std::optional<double> border_k;  ///< of the border; absent: see border_to_white
  double border_to_white = 0;      ///< 0: the border is as warm as black, 1: as white

  /// Black's temperature at a place, `black` false: white's.
  double At(const Eigen::Vector2d& place, bool black) const {
    return Between(place, black ? 0 : 1);
  }
  /// The border's temperature at a place.
  double BorderAt(const Eigen::Vector2d& place) const;

 private:
  /// `whiteness` 0: black's temperature, 1: white's.
  double Between(const Eigen::Vector2d& place, double whiteness) const;
};

/// The board where it stands. Front face in z = 0 of the target frame.
class Board {
 public:
  Board(const BoardOptions& options, const Rigid3& lidar_from_target, const HeatMap& heat);

  const Rigid3& lidar_from_target() const { return lidar_from_target_; }
  const HeatMap& heat() const { return heat_; }
  const BoardOptions& options() const { return options_; }
  void set_heat(const HeatMap& heat) { heat_ = heat; }

  /// The board's own shape, LIDAR frame.
  Mesh Shape() const;
  /// Parts of the stand: an arm from the board's back, a pole and a foot, hidden behind the board
  /// but for what shows under it. LIDAR frame.
  std::vector<Mesh> Stand(double ground_z) const;

  /// Which patch of colour a place [m] lies in: 0 the border, otherwise a square's number from 1;
  /// after these, cells of markers that are not of their square's colour.
  int Patch(const Eigen::Vector2d& place) const;
  bool IsBlack(int patch) const;
  double Reflectivity(const Eigen::Vector3d& point_in_lidar) const;
  /// Material at a point on the board, LIDAR frame. `patch`: see Patch(); -1 on sides and back.
  Material At(const Eigen::Vector3d& point_in_lidar, int* patch) const;

 private:
  /// Patch of a point in the target frame; -1 on sides and back.
  int PatchOf(const Eigen::Vector3d& point_in_target) const;

  /// Cell of a marker, if there is one of another colour than its square's: its number from 0.
  std::optional<int> CellOf(const Eigen::Vector2d& place, int column, int row) const;

  BoardOptions options_;
  Target target_;
  std::shared_ptr<const MarkerBits> bits_;             ///< null: no markers
  std::vector<std::optional<MarkerPlace>> marker_in_;  ///< each square, row by row
  Rigid3 lidar_from_target_, target_from_lidar_;
  HeatMap heat_;
};

/// A uneven heating drawn from (seed, index), without a hidden stretch.
HeatMap DrawHeat(const BoardOptions& options, const BoardHeat& scene, std::uint64_t seed,
                 int index);

/// As a rig file has it: it does not know how it was printed.
Target MakeTarget(const BoardOptions& options);

}  // namespace rgbdt::simulate
