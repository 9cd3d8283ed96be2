#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace rgbdt {

/// What a distance field is worth outside its image.
enum class FieldBeyond {
  kBorderValue,  ///< the border pixel's value, as in the paper: flat, nothing leads back
  /// Grows with the distance from the border; value and slope go on where it is crossed.
  kSmooth,
};

/// Distance [px] from any place in an image to the target's nearest edge pixel (paper II-A.3), made
/// continuous by a second-degree polynomial fitted to the 10x10 window (offsets -5..+4) round the
/// pixel that a point falls on. Surfaces are computed only where points fall and kept in a look-up
/// table, so an object is for one thread at a time.
class DistanceField {
 public:
  /// At least one edge pixel inside the image. Throws InputError otherwise.
  DistanceField(int width, int height, const std::vector<Eigen::Vector2i>& edge_pixels,
                FieldBeyond beyond = FieldBeyond::kBorderValue);

  /// Value of the surface at a pixel position; outside the image as FieldBeyond says.
  double Value(const Eigen::Vector2d& pixel) const;

  /// The distance transform itself at the nearest pixel; outside the image the border's value.
  double Nearest(const Eigen::Vector2d& pixel) const;

  int width() const { return transform_.cols; }
  int height() const { return transform_.rows; }
  FieldBeyond beyond() const { return beyond_; }

 private:
  // Coefficients of 1, x, y, x^2, xy, y^2 about the pixel.
  using Surface = Eigen::Matrix<double, 6, 1>;
  // A pixel's surface, and where a point lies from it.
  struct Place {
    const Surface& surface;
    Eigen::Vector2d offset;
  };
  Place PlaceOf(const Eigen::Vector2d& point) const;
  const Surface& SurfaceAt(int x, int y) const;
  Surface Fit(int x, int y) const;
  double Inside(const Eigen::Vector2d& pixel) const;
  Eigen::Vector2d Slope(const Eigen::Vector2d& pixel) const;
  double Smooth(const Eigen::Vector2d& border, const Eigen::Vector2d& off) const;

  FieldBeyond beyond_;
  cv::Mat transform_;                         // CV_32F
  mutable std::vector<std::int32_t> lookup_;  // by pixel: index into surfaces_, -1: not yet
  mutable std::vector<Surface> surfaces_;
};

}  // namespace rgbdt
