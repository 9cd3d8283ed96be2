#pragma once

#include <cstddef>
#include <vector>

#include "calib/camera/project_points.h"

namespace rgbdt {

/// The surfaces that hide things from a camera, as a cloud shows them: cells somewhat larger than
/// the points' spacing in the image, each with the plane of its nearest points. Of a plane, 1/range
/// is linear in the pixel (but for the lens's distortion within a cell), so a slanted surface does
/// not hide itself, however coarse the cells. Depth buffering: Catmull 1974; its slope: King 2004.
class DepthBuffer {
 public:
  /// Cells of this size [px], along u and v; `range_sigma_m`: noise of a range.
  DepthBuffer(const Camera& camera, const Eigen::Vector2d& cell_px, double range_sigma_m);

  /// The block's first `count` points. Those a little outside of the image count, too: they hide
  /// what lies inside.
  void Add(const PixelBlock& block, std::size_t count);

  /// Makes surfaces of what was added since the last call.
  void Close();

  /// Whether a point at this pixel of the image is hidden by what was added and closed.
  bool Hides(float u, float v, float inverse_range) const {
    const float nearer = SurfaceAt(u, v) - inverse_range;
    return nearer > inverse_range * (kBehind + inverse_range * absolute_m_);
  }

  /// Inverse range of the surface at a pixel of the image; 0 or less: none.
  float SurfaceAt(float u, float v) const { return planes_[CellOf(u, v)].At(u, v); }

  /// Cosine of the angle between the line of sight and the surface's normal at a pixel of the
  /// image; 1 where nothing is known.
  float CosineAt(float u, float v) const;

  const Eigen::Vector2d& cell_px() const { return cell_px_; }
  void Clear();

 private:
  // The nearest points of a cell, within the noise of each other.
  struct Layer {
    float nearest = 0;  // inverse range
    float count = 0, sum_u = 0, sum_v = 0, sum_w = 0;
  };
  // A layer's middle and how its inverse range changes from pixel to pixel.
  struct Surfel {
    float u = 0, v = 0, w = 0, by_u = 0, by_v = 0;
  };
  struct Plane {
    float w = 0, by_u = 0, by_v = 0;  // inverse range at pixel (0, 0) and its slopes
    float At(float u, float v) const { return w + by_u * u + by_v * v; }
  };

  std::size_t CellOf(float u, float v) const {
    const int column = static_cast<int>(u * per_u_ + kMargin);
    const int row = static_cast<int>(v * per_v_ + kMargin);
    return static_cast<std::size_t>(row) * columns_ + static_cast<std::size_t>(column);
  }
  bool InGrid(float u, float v) const {
    return u > least_u_ && v > least_v_ && u < most_u_ && v < most_v_;
  }
  void Touch(std::size_t cell);
  void GrowTouched();
  template <typename Make>
  void ForTouched(Make make);
  void MakeSurfel(std::size_t cell);
  void MakeSlopes(std::size_t cell);
  void Offer(std::size_t cell);

  static constexpr int kMargin = 3;         // cells round the image
  static constexpr float kBehind = 0.005F;  // how far behind a surface hides, besides the noise

  Eigen::Vector2d cell_px_;
  float cell_u_, cell_v_, per_u_, per_v_;  // of a cell [px], and cells a pixel
  float focal_u_, focal_v_;                // [px]
  float least_u_, least_v_, most_u_, most_v_;
  float absolute_m_;  // of the noise
  std::size_t columns_, rows_;
  std::vector<Layer> layers_;
  std::vector<Surfel> surfels_;
  std::vector<Plane> planes_;
  std::size_t first_row_, end_row_, first_column_, end_column_;  // touched since Close
};

}  // namespace rgbdt
