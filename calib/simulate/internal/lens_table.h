#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "calib/model/rig.h"

namespace rgbdt::simulate {

/// The simulator's own lens: shares no code with calib/camera, so that a mistake there cannot hide.
/// Distortion as in OpenCV's documentation: x, y on the plane z = 1, r^2 = x^2 + y^2,
///   c = (1 + k1 r^2 + k2 r^4 + k3 r^6) / (1 + k4 r^2 + k5 r^4 + k6 r^6)
///   x' = c x + 2 p1 x y + p2 (r^2 + 2 x^2),  y' = c y + p1 (r^2 + 2 y^2) + 2 p2 x y
///   u = fx x' + cx,  v = fy y' + cy                      (pixel centres at integers)
class LensTable {
 public:
  LensTable(const Lens& lens, int width, int height);

  /// Pixel [px] of a point on the plane z = 1.
  Eigen::Vector2d Distort(const Eigen::Vector2d& normalised) const;
  /// Point on the plane z = 1 that is seen at a pixel: Newton from `start`, to 1e-13.
  Eigen::Vector2d Undistort(const Eigen::Vector2d& pixel, const Eigen::Vector2d& start) const;
  /// The same for a pixel's centre, from the table that Fill() makes.
  const Eigen::Vector2d& At(int column, int row) const {
    return table_[static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) +
                  static_cast<std::size_t>(column)];
  }
  /// Pixel of a point in camera coordinates [m]; nothing if behind, or farther from the axis than
  /// the image's farthest corner (beyond it the distortion may fold back).
  std::optional<Eigen::Vector2d> Project(const Eigen::Vector3d& point_in_camera) const;

  /// Computes the table; apart from the constructor because it takes some 0.2 s.
  void Fill();
  bool filled() const { return !table_.empty(); }

 private:
  Lens lens_;
  int width_, height_;
  double max_radius_ = 0;  ///< of the image's corners on the plane z = 1
  std::vector<Eigen::Vector2d> table_;
};

/// Throws InputError if the lens is not pinhole, or folds back inside the image.
void CheckLens(const Lens& lens, int width, int height, const std::string& field);

}  // namespace rgbdt::simulate
