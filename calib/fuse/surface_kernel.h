#pragma once

// Inside calib/fuse only: the loops of depth_buffer.h, over cells of a row and over points.

#include <cstddef>
#include <cstdint>

namespace rgbdt {

/// Rows of cells over an image, some more of them round it.
struct CellGrid {
  static constexpr int kMargin = 3;  ///< cells round the image

  float cell_u, cell_v, per_u, per_v;      ///< of a cell [px], and cells a pixel
  float least_u, least_v, most_u, most_v;  ///< pixels that have a cell, but the outermost
  std::size_t columns, rows;

  std::size_t size() const { return columns * rows; }
  /// Of a pixel between least and most.
  std::size_t CellOf(float u, float v) const {
    const int column = static_cast<int>(u * per_u + kMargin);
    const int row = static_cast<int>(v * per_v + kMargin);
    return static_cast<std::size_t>(row) * columns + static_cast<std::size_t>(column);
  }
};

// What is kept by cell, row by row:
// - sums: of its nearest points' u, v, w and 1, side by side; w: inverse range;
// - surfels, columns one after the other: their middle u, v, w and its slopes by_u, by_v: how w
//   changes from pixel to pixel; w = 0: none;
// - planes, side by side: w at pixel (0, 0), its slopes, and one float more.
inline constexpr std::size_t kSumFloats = 4;
inline constexpr std::size_t kSurfelFloats = 5;
inline constexpr std::size_t kPlaneFloats = 4;

inline constexpr std::size_t kSurfaceBlock = 512;  ///< points at a time, at most

/// By point: pixel and inverse range.
struct PixelColumns {
  const float *u, *v, *w;
};

/// The points' cells; -1: no point, or beyond the grid.
void FindCells(const CellGrid& grid, const PixelColumns& points, std::size_t count,
               std::int32_t* cells);

/// Cells [first, end) of one row.
void MakeSurfels(const CellGrid& grid, const float* sums, std::size_t first, std::size_t end,
                 float* surfels);
void MakeSlopes(const CellGrid& grid, std::size_t first, std::size_t end, float* surfels);
void MakePlanes(const CellGrid& grid, const float* surfels, std::size_t first, std::size_t end,
                float* planes);

/// Whether a surface occludes what has this inverse range: it lies behind it, and not only by the
/// noise.
inline bool IsBehind(float surface, float inverse_range, float absolute_m) {
  constexpr float kBehind = 0.005F;  // of the range, besides the noise
  return surface - inverse_range > inverse_range * (kBehind + inverse_range * absolute_m);
}

/// occluded[i] = 1 where point i, a pixel of the image, is behind its cell's surface in one of
/// both; otherwise 0.
void FindOccluded(const CellGrid& grid, const float* planes, const float* other_planes,
                  float absolute_m, const PixelColumns& points, std::size_t count,
                  std::uint8_t* occluded);

}  // namespace rgbdt
