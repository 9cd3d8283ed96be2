#include "calib/fuse/depth_buffer.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rgbdt {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
constexpr float kBand = 0.01F;      // of a layer's depth, besides the noise
constexpr float kSigmas = 4;        // of the noise
constexpr float kReach = 1.05F;     // cells from a layer's middle to the middle of a cell it fills
constexpr float kMostSlope = 0.3F;  // credible change of 1/range over a cell, as a part of it

// Of the slopes to both sides the flatter one, if they lean the same way (minmod: the steeper one
// leaves the surface); where one side shows nothing, the other if it is credible.
float Flatter(float a, float b, float most) {
  if (std::isnan(a)) a = std::abs(b) < most ? b : 0;
  if (std::isnan(b)) b = std::abs(a) < most ? a : 0;
  if (!(a * b > 0)) return 0;
  return std::abs(a) < std::abs(b) ? a : b;
}

}  // namespace

DepthBuffer::DepthBuffer(const Camera& camera, const Eigen::Vector2d& cell_px, double range_sigma_m)
    : cell_px_(cell_px),
      cell_u_(static_cast<float>(cell_px.x())),
      cell_v_(static_cast<float>(cell_px.y())),
      per_u_(1 / cell_u_),
      per_v_(1 / cell_v_),
      focal_u_(static_cast<float>(camera.lens().fx)),
      focal_v_(static_cast<float>(camera.lens().fy)),
      least_u_(-(kMargin - 1) * cell_u_),
      least_v_(-(kMargin - 1) * cell_v_),
      most_u_(static_cast<float>(camera.width()) + (kMargin - 2) * cell_u_),
      most_v_(static_cast<float>(camera.height()) + (kMargin - 2) * cell_v_),
      absolute_m_(kSigmas * static_cast<float>(range_sigma_m)),
      columns_(static_cast<std::size_t>(std::ceil(camera.width() / cell_px.x())) + 2 * kMargin),
      rows_(static_cast<std::size_t>(std::ceil(camera.height() / cell_px.y())) + 2 * kMargin),
      layers_(columns_ * rows_),
      surfels_(columns_ * rows_),
      planes_(columns_ * rows_),
      first_row_(rows_),
      end_row_(0),
      first_column_(columns_),
      end_column_(0) {}

void DepthBuffer::Clear() {
  std::fill(layers_.begin(), layers_.end(), Layer{});
  std::fill(surfels_.begin(), surfels_.end(), Surfel{});
  std::fill(planes_.begin(), planes_.end(), Plane{});
}

void DepthBuffer::Add(const PixelBlock& block, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    const float u = block.u[i];
    const float v = block.v[i];
    const float w = block.inverse_range[i];
    if (!(w > 0) || !InGrid(u, v)) continue;
    const std::size_t cell = CellOf(u, v);
    Layer& layer = layers_[cell];
    const float band = w * (kBand + w * absolute_m_);
    if (w < layer.nearest - band) continue;
    if (w > layer.nearest + band) {
      layer = {w, 0, 0, 0, 0};
      Touch(cell);
    }
    layer.count += 1;
    layer.sum_u += u;
    layer.sum_v += v;
    layer.sum_w += w;
  }
}

void DepthBuffer::Touch(std::size_t cell) {
  const std::size_t row = cell / columns_;
  const std::size_t column = cell % columns_;
  first_row_ = std::min(first_row_, row);
  end_row_ = std::max(end_row_, row + 1);
  first_column_ = std::min(first_column_, column);
  end_column_ = std::max(end_column_, column + 1);
}

// A surface's slope depends on its neighbours, a cell's plane on its neighbours' slopes. The
// outermost cells stay empty: InGrid leaves a margin of two.
void DepthBuffer::GrowTouched() {
  first_row_ = std::max<std::size_t>(first_row_, 2) - 1;
  first_column_ = std::max<std::size_t>(first_column_, 2) - 1;
  end_row_ = std::min(end_row_ + 1, rows_ - 1);
  end_column_ = std::min(end_column_ + 1, columns_ - 1);
}

template <typename Make>
void DepthBuffer::ForTouched(Make make) {
  for (std::size_t row = first_row_; row < end_row_; ++row) {
    for (std::size_t column = first_column_; column < end_column_; ++column) {
      make(row * columns_ + column);
    }
  }
}

void DepthBuffer::Close() {
  if (end_row_ <= first_row_) return;
  ForTouched([&](std::size_t cell) { MakeSurfel(cell); });
  GrowTouched();
  for (int round = 0; round < 2; ++round) {  // each slope is in the other's way
    ForTouched([&](std::size_t cell) { MakeSlopes(cell); });
  }
  GrowTouched();
  ForTouched([&](std::size_t cell) { planes_[cell] = {}; });
  GrowTouched();
  ForTouched([&](std::size_t cell) { Offer(cell); });  // what others have taken, they take again
  first_row_ = rows_;
  end_row_ = 0;
  first_column_ = columns_;
  end_column_ = 0;
}

void DepthBuffer::MakeSurfel(std::size_t cell) {
  const Layer& layer = layers_[cell];
  if (layer.count == 0) return;
  Surfel& surfel = surfels_[cell];
  surfel.u = layer.sum_u / layer.count;
  surfel.v = layer.sum_v / layer.count;
  surfel.w = layer.sum_w / layer.count;
}

void DepthBuffer::MakeSlopes(std::size_t cell) {
  Surfel& s = surfels_[cell];
  if (s.w == 0) return;
  const auto by_u = [&](const Surfel& other) {
    return other.w == 0 ? kNone : (other.w - s.w - s.by_v * (other.v - s.v)) / (other.u - s.u);
  };
  const auto by_v = [&](const Surfel& other) {
    return other.w == 0 ? kNone : (other.w - s.w - s.by_u * (other.u - s.u)) / (other.v - s.v);
  };
  const float most = kMostSlope * s.w;
  s.by_v = Flatter(by_v(surfels_[cell - columns_]), by_v(surfels_[cell + columns_]), most * per_v_);
  s.by_u = Flatter(by_u(surfels_[cell - 1]), by_u(surfels_[cell + 1]), most * per_u_);
}

// Of the surfaces in and beside a cell that reach its middle, the nearest there counts: each offers
// itself to the cells that it reaches.
void DepthBuffer::Offer(std::size_t cell) {
  const Surfel& s = surfels_[cell];
  if (s.w == 0) return;
  const auto column = static_cast<float>(cell % columns_) - kMargin + 0.5F;
  const auto row = static_cast<float>(cell / columns_) - kMargin + 0.5F;
  const float right = s.u * per_u_ - column;  // of the cell's middle [cells]
  const float below = s.v * per_v_ - row;
  const Plane plane{s.w - s.by_u * s.u - s.by_v * s.v, s.by_u, s.by_v};
  for (int dr = 1 + below <= kReach ? -1 : 0; dr <= (1 - below <= kReach ? 1 : 0); ++dr) {
    for (int dc = 1 + right <= kReach ? -1 : 0; dc <= (1 - right <= kReach ? 1 : 0); ++dc) {
      const float u = (column + static_cast<float>(dc)) * cell_u_;
      const float v = (row + static_cast<float>(dr)) * cell_v_;
      Plane& best =
          planes_[cell + static_cast<std::size_t>(dr) * columns_ + static_cast<std::size_t>(dc)];
      if (plane.At(u, v) > best.At(u, v)) best = plane;
    }
  }
}

float DepthBuffer::CosineAt(float u, float v) const {
  const Plane& plane = planes_[CellOf(u, v)];
  const float w = plane.At(u, v);
  if (!(w > 0)) return 1;
  // Of a plane, the relative change of 1/range by angle is the tangent of the incidence.
  const float tangent_u = plane.by_u * focal_u_ / w;
  const float tangent_v = plane.by_v * focal_v_ / w;
  return 1 / std::sqrt(1 + tangent_u * tangent_u + tangent_v * tangent_v);
}

}  // namespace rgbdt
