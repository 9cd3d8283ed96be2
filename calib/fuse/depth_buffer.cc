#include "calib/fuse/depth_buffer.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace rgbdt {
namespace {

constexpr float kBand = 0.01F;  // of a layer's depth, besides the noise
constexpr float kSigmas = 4;    // of the noise

CellGrid GridOver(const Camera& camera, const Eigen::Vector2d& cell_px) {
  constexpr int kMargin = CellGrid::kMargin;
  const auto cell_u = static_cast<float>(cell_px.x());
  const auto cell_v = static_cast<float>(cell_px.y());
  return {cell_u,
          cell_v,
          1 / cell_u,
          1 / cell_v,
          -(kMargin - 1) * cell_u,
          -(kMargin - 1) * cell_v,
          static_cast<float>(camera.width()) + (kMargin - 2) * cell_u,
          static_cast<float>(camera.height()) + (kMargin - 2) * cell_v,
          static_cast<std::size_t>(std::ceil(camera.width() / cell_px.x())) + 2 * kMargin,
          static_cast<std::size_t>(std::ceil(camera.height() / cell_px.y())) + 2 * kMargin};
}

}  // namespace

DepthBuffer::DepthBuffer(const Camera& camera, const Eigen::Vector2d& cell_px, double range_sigma_m)
    : cell_px_(cell_px),
      grid_(GridOver(camera, cell_px)),
      focal_u_(static_cast<float>(camera.lens().fx)),
      focal_v_(static_cast<float>(camera.lens().fy)),
      absolute_m_(kSigmas * static_cast<float>(range_sigma_m)),
      nearest_(grid_.size()),
      sums_(grid_.size()),
      surfels_(kSurfelFloats * grid_.size()),
      planes_(kPlaneFloats * grid_.size()),
      first_row_(grid_.rows),
      end_row_(0),
      first_column_(grid_.columns),
      end_column_(0) {}

void DepthBuffer::Clear() {
  std::fill(nearest_.begin(), nearest_.end(), 0.0F);
  std::fill(sums_.begin(), sums_.end(), Sums{});
  std::fill(surfels_.begin(), surfels_.end(), 0.0F);
  std::fill(planes_.begin(), planes_.end(), 0.0F);
}

void DepthBuffer::Add(const PixelBlock& block, std::size_t count) {
  std::array<std::int32_t, PixelBlock::kSize> cells;
  FindCells(grid_, {block.u, block.v, block.inverse_range}, count, cells.data());
  for (std::size_t i = 0; i < count; ++i) {
    if (cells[i] < 0) continue;
    const auto cell = static_cast<std::size_t>(cells[i]);
    const float w = block.inverse_range[i];
    const float band = w * (kBand + w * absolute_m_);
    if (w < nearest_[cell] - band) continue;
    if (w > nearest_[cell] + band) {
      nearest_[cell] = w;
      sums_[cell] = Sums{};
      Touch(cell);
    }
    sums_[cell] += Sums{block.u[i], block.v[i], w, 1};
  }
}

void DepthBuffer::Touch(std::size_t cell) {
  const std::size_t row = cell / grid_.columns;
  const std::size_t column = cell % grid_.columns;
  first_row_ = std::min(first_row_, row);
  end_row_ = std::max(end_row_, row + 1);
  first_column_ = std::min(first_column_, column);
  end_column_ = std::max(end_column_, column + 1);
}

// A surface's slope depends on its neighbours, a cell's plane on its neighbours' slopes. The
// outermost cells stay empty: the grid leaves a margin of two.
void DepthBuffer::GrowTouched() {
  first_row_ = std::max<std::size_t>(first_row_, 2) - 1;
  first_column_ = std::max<std::size_t>(first_column_, 2) - 1;
  end_row_ = std::min(end_row_ + 1, grid_.rows - 1);
  end_column_ = std::min(end_column_ + 1, grid_.columns - 1);
}

// make(first cell of the row, end)
template <typename Make>
void DepthBuffer::ForTouchedRows(Make make) {
  for (std::size_t row = first_row_; row < end_row_; ++row) {
    make(row * grid_.columns + first_column_, row * grid_.columns + end_column_);
  }
}

void DepthBuffer::Close() {
  if (end_row_ <= first_row_) return;
  const auto* sums = reinterpret_cast<const float*>(sums_.data());
  float* surfels = surfels_.data();
  float* planes = planes_.data();
  ForTouchedRows([&](auto first, auto end) { MakeSurfels(grid_, sums, first, end, surfels); });
  GrowTouched();
  ForTouchedRows([&](auto first, auto end) { MakeSlopes(grid_, first, end, surfels); });
  GrowTouched();
  ForTouchedRows([&](auto first, auto end) { MakePlanes(grid_, surfels, first, end, planes); });
  first_row_ = grid_.rows;
  end_row_ = 0;
  first_column_ = grid_.columns;
  end_column_ = 0;
}

void DepthBuffer::FindOccluded(const DepthBuffer& other, const PixelColumns& points,
                               std::size_t count, std::uint8_t* occluded) const {
  rgbdt::FindOccluded(grid_, planes_.data(), other.planes_.data(), absolute_m_, points, count,
                      occluded);
}

float DepthBuffer::CosineAt(float u, float v) const {
  const float w = SurfaceAt(u, v);
  if (!(w > 0)) return 1;
  // Of a plane, the relative change of 1/range by angle is the tangent of the incidence.
  const float* plane = &planes_[kPlaneFloats * grid_.CellOf(u, v)];
  const float tangent_u = plane[1] * focal_u_ / w;
  const float tangent_v = plane[2] * focal_v_ / w;
  return 1 / std::sqrt(1 + tangent_u * tangent_u + tangent_v * tangent_v);
}

}  // namespace rgbdt
