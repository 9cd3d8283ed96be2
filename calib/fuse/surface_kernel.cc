#include "calib/fuse/surface_kernel.h"

#include <cmath>
#include <cstring>
#include <limits>

#include "calib/camera/simd_dispatch.h"

namespace rgbdt {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
constexpr float kReach = 1.05F;     // cells from a layer's middle to the middle of a cell it fills
constexpr float kMostSlope = 0.3F;  // credible change of 1/range over a cell, as a part of it

// Of the slopes to both sides the flatter one, if they lean the same way (minmod: the steeper one
// leaves the surface); where one side shows nothing (NaN), the other if it is credible.
inline float Flatter(float a, float b, float most) {
  const float alone_a = std::fabs(a) < most ? a : 0;
  const float alone_b = std::fabs(b) < most ? b : 0;
  const float from = a != a ? alone_b : a;
  const float to = b != b ? alone_a : b;
  const float flatter = std::fabs(from) < std::fabs(to) ? from : to;
  return from * to > 0 ? flatter : 0;
}

// Sums and planes: side by side, for a cell's are fetched together.
using FourFloats = float __attribute__((vector_size(16)));

inline FourFloats FourAt(const float* fours, std::int32_t index) {
  FourFloats four;
  std::memcpy(&four, fours + 4 * static_cast<std::ptrdiff_t>(index), sizeof four);
  return four;
}

struct Surfels {
  const float *u, *v, *w, *by_u, *by_v;

  Surfels(const CellGrid& grid, const float* surfels)
      : u(surfels),
        v(u + grid.size()),
        w(v + grid.size()),
        by_u(w + grid.size()),
        by_v(by_u + grid.size()) {}
};

// From a surface's middle to another one's; NaN: there is no other.
struct Step {
  float u, v, w;
};

inline Step StepTo(const Surfels& s, std::size_t from, std::size_t to) {
  return {s.u[to] - s.u[from], s.v[to] - s.v[from], s.w[to] == 0 ? kNone : s.w[to] - s.w[from]};
}

struct Plane {
  float w, by_u, by_v;
};

// The surface of cell `of`, which lies at (column, row), instead of `best` where it is nearer in
// the middle of the cell kDu columns and kDv rows further, and reaches there.
template <int kDu, int kDv>
inline __attribute__((always_inline)) void Offer(const CellGrid& grid, const Surfels& s,
                                                 std::size_t of, float column, float row,
                                                 Plane* best) {
  const float u = (column + kDu) * grid.cell_u;
  const float v = (row + kDv) * grid.cell_v;
  const float right = s.u[of] * grid.per_u - column;  // of its cell's middle [cells]
  const float below = s.v[of] * grid.per_v - row;
  const float by_u = s.by_u[of];
  const float by_v = s.by_v[of];
  const float w = s.w[of] - by_u * s.u[of] - by_v * s.v[of];
  const bool reaches =
      (kDu == 0 || 1 - kDu * right <= kReach) & (kDv == 0 || 1 - kDv * below <= kReach);
  const bool nearer = w + by_u * u + by_v * v > best->w + best->by_u * u + best->by_v * v;
  const bool takes = reaches & nearer & (s.w[of] != 0);
  best->w = takes ? w : best->w;
  best->by_u = takes ? by_u : best->by_u;
  best->by_v = takes ? by_v : best->by_v;
}

}  // namespace

RGBDT_SIMD_DISPATCH
void FindCells(const CellGrid& grid, const PixelColumns& points, std::size_t count,
               std::int32_t* cells) {
  const CellGrid g = grid;
  const auto columns = static_cast<std::int32_t>(g.columns);
  RGBDT_INDEPENDENT
  for (std::size_t i = 0; i < count; ++i) {
    const float u = points.u[i];
    const float v = points.v[i];
    const bool in =
        (points.w[i] > 0) & (u > g.least_u) & (v > g.least_v) & (u < g.most_u) & (v < g.most_v);
    const auto column = static_cast<std::int32_t>((in ? u : 0) * g.per_u + CellGrid::kMargin);
    const auto row = static_cast<std::int32_t>((in ? v : 0) * g.per_v + CellGrid::kMargin);
    cells[i] = in ? row * columns + column : -1;
  }
}

RGBDT_SIMD_DISPATCH
void MakeSurfels(const CellGrid& grid, const float* sums, std::size_t first, std::size_t end,
                 float* surfels) {
  float* u = surfels;
  float* v = u + grid.size();
  float* w = v + grid.size();
  RGBDT_INDEPENDENT
  for (std::size_t i = first; i < end; ++i) {
    const float count = sums[kSumFloats * i + 3];
    const float most = count > 0 ? count : 1;
    u[i] = sums[kSumFloats * i] / most;
    v[i] = sums[kSumFloats * i + 1] / most;
    w[i] = sums[kSumFloats * i + 2] / most;
  }
}

RGBDT_SIMD_DISPATCH
void MakeSlopes(const CellGrid& grid, std::size_t first, std::size_t end, float* surfels) {
  const Surfels s(grid, surfels);
  float* slope_u = surfels + (s.by_u - s.u);
  float* slope_v = surfels + (s.by_v - s.u);
  const std::size_t columns = grid.columns;
  const float per_u = grid.per_u;
  const float per_v = grid.per_v;
  RGBDT_INDEPENDENT
  for (std::size_t i = first; i < end; ++i) {
    const float most_u = kMostSlope * s.w[i] * per_u;
    const float most_v = kMostSlope * s.w[i] * per_v;
    const Step above = StepTo(s, i, i - columns);
    const Step below = StepTo(s, i, i + columns);
    const Step left = StepTo(s, i, i - 1);
    const Step right = StepTo(s, i, i + 1);
    const auto along_v = [&](float by_u) {
      return Flatter((above.w - by_u * above.u) / above.v, (below.w - by_u * below.u) / below.v,
                     most_v);
    };
    const auto along_u = [&](float by_v) {
      return Flatter((left.w - by_v * left.v) / left.u, (right.w - by_v * right.v) / right.u,
                     most_u);
    };
    // Each slope is in the other's way: two rounds.
    const float by_u = along_u(along_v(slope_u[i]));
    const float by_v = along_v(by_u);
    slope_v[i] = s.w[i] == 0 ? 0 : by_v;
    slope_u[i] = s.w[i] == 0 ? 0 : along_u(by_v);
  }
}

// Of the surfaces in and beside a cell that reach its middle, the nearest there counts.
RGBDT_SIMD_DISPATCH
void MakePlanes(const CellGrid& grid, const float* surfels, std::size_t first, std::size_t end,
                float* planes) {
  const CellGrid g = grid;
  const Surfels s(grid, surfels);
  const auto first_column = static_cast<int>(first % g.columns);
  const std::size_t first_row = first / g.columns;
  const float row = static_cast<float>(first_row) - CellGrid::kMargin + 0.5F;
  const auto count = static_cast<int>(end - first);
  RGBDT_INDEPENDENT
  for (int k = 0; k < count; ++k) {
    const std::size_t i = first + static_cast<std::size_t>(k);
    const float column = static_cast<float>(first_column + k) - CellGrid::kMargin + 0.5F;
    Plane best{0, 0, 0};
    Offer<1, 1>(g, s, i - g.columns - 1, column - 1, row - 1, &best);
    Offer<0, 1>(g, s, i - g.columns, column, row - 1, &best);
    Offer<-1, 1>(g, s, i - g.columns + 1, column + 1, row - 1, &best);
    Offer<1, 0>(g, s, i - 1, column - 1, row, &best);
    Offer<0, 0>(g, s, i, column, row, &best);
    Offer<-1, 0>(g, s, i + 1, column + 1, row, &best);
    Offer<1, -1>(g, s, i + g.columns - 1, column - 1, row + 1, &best);
    Offer<0, -1>(g, s, i + g.columns, column, row + 1, &best);
    Offer<-1, -1>(g, s, i + g.columns + 1, column + 1, row + 1, &best);
    planes[kPlaneFloats * i] = best.w;
    planes[kPlaneFloats * i + 1] = best.by_u;
    planes[kPlaneFloats * i + 2] = best.by_v;
    planes[kPlaneFloats * i + 3] = 0;
  }
}

// In steps, as what is fetched from anywhere is best fetched at once: the processor waits for many.
RGBDT_SIMD_DISPATCH
void FindOccluded(const CellGrid& grid, const float* planes, const float* other_planes,
                  float absolute_m, const PixelColumns& points, std::size_t count,
                  std::uint8_t* occluded) {
  const CellGrid g = grid;
  const auto columns = static_cast<std::int32_t>(g.columns);
  const PixelColumns p = points;
  std::int32_t cells[kSurfaceBlock];
  for (std::size_t i = 0; i < count; ++i) {
    const auto column = static_cast<std::int32_t>(p.u[i] * g.per_u + CellGrid::kMargin);
    const auto row = static_cast<std::int32_t>(p.v[i] * g.per_v + CellGrid::kMargin);
    cells[i] = row * columns + column;
  }
  alignas(16) float a[4 * kSurfaceBlock], b[4 * kSurfaceBlock];
  for (std::size_t i = 0; i < count; ++i) {
    const FourFloats one = FourAt(planes, cells[i]);
    const FourFloats other = FourAt(other_planes, cells[i]);
    std::memcpy(a + 4 * i, &one, sizeof one);
    std::memcpy(b + 4 * i, &other, sizeof other);
  }
  std::int32_t is_occluded[kSurfaceBlock];
  for (std::size_t i = 0; i < count; ++i) {
    const float u = p.u[i];
    const float v = p.v[i];
    const float in_one = a[4 * i] + a[4 * i + 1] * u + a[4 * i + 2] * v;
    const float in_other = b[4 * i] + b[4 * i + 1] * u + b[4 * i + 2] * v;
    is_occluded[i] = IsBehind(in_one > in_other ? in_one : in_other, p.w[i], absolute_m) ? 1 : 0;
  }
  for (std::size_t i = 0; i < count; ++i) occluded[i] = static_cast<std::uint8_t>(is_occluded[i]);
}

}  // namespace rgbdt
