#pragma once

#include <cstddef>
#include <vector>

#include "calib/camera/project_points.h"
#include "calib/fuse/surface_kernel.h"

namespace rgbdt {

/// The surfaces that occlude things from a camera, as a cloud shows them: cells somewhat larger
/// than the points' spacing in the image, each with the plane of its nearest points. Of a plane,
/// 1/range is linear in the pixel (but for the lens's distortion within a cell), so a slanted
/// surface does not hide itself, however coarse the cells. Depth buffering: Catmull 1974; its
/// slope: King 2004.
class DepthBuffer {
 public:
  /// Cells of this size [px], along u and v; `range_sigma_m`: noise of a range.
  DepthBuffer(const Camera& camera, const Eigen::Vector2d& cell_px, double range_sigma_m);

  /// The block's first `count` points. Those a little outside of the image count, too: they
  /// occlude what lies inside.
  void Add(const PixelBlock& block, std::size_t count);

  /// Makes surfaces of what was added since the last call.
  void Close();

  /// occluded[i] = 1 where point i, a pixel of the image, is occluded by what was added and closed,
  /// here or in another buffer of the same cells; otherwise 0.
  void FindOccluded(const DepthBuffer& other, const PixelColumns& points, std::size_t count,
                    std::uint8_t* occluded) const;

  /// Whether a point at this pixel of the image is occluded.
  bool Occludes(float u, float v, float inverse_range) const {
    return IsBehind(SurfaceAt(u, v), inverse_range, absolute_m_);
  }

  /// Inverse range of the surface at a pixel of the image; 0 or less: none.
  float SurfaceAt(float u, float v) const {
    const float* plane = &planes_[kPlaneFloats * grid_.CellOf(u, v)];
    return plane[0] + plane[1] * u + plane[2] * v;
  }

  /// Cosine of the angle between the line of sight and the surface's normal at a pixel of the
  /// image; 1 where nothing is known.
  float CosineAt(float u, float v) const;

  const Eigen::Vector2d& cell_px() const { return cell_px_; }
  void Clear();

 private:
  void Touch(std::size_t cell);
  void GrowTouched();
  template <typename Make>
  void ForTouchedRows(Make make);

  // Of a cell's nearest points, within the noise of each other.
  using Sums = float __attribute__((vector_size(16)));  // u, v, inverse range and 1

  Eigen::Vector2d cell_px_;
  CellGrid grid_;
  float focal_u_, focal_v_;  // [px]
  float absolute_m_;         // of the noise
  // By cell, row by row.
  std::vector<float> nearest_;  // inverse range that the sums are about
  std::vector<Sums> sums_;
  std::vector<float> surfels_, planes_;
  std::size_t first_row_, end_row_, first_column_, end_column_;  // touched since Close
};

}  // namespace rgbdt
