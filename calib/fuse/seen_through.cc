#include "calib/fuse/seen_through.h"

#include <algorithm>
#include <cmath>

namespace rgbdt {
namespace {

constexpr int kCells = 180;  // along the edge of a face
constexpr std::size_t kFace = static_cast<std::size_t>(kCells) * kCells;

struct Direction {
  std::size_t face = 0;
  int row = 0, column = 0;
};

// The face where the largest coordinate's axis goes through, and where on it.
Direction DirectionOf(const Eigen::Vector3f& p) {
  const Eigen::Array3f size = p.array().abs();
  const int axis = size.x() >= size.y() && size.x() >= size.z() ? 0 : size.y() >= size.z() ? 1 : 2;
  const float scale = 0.5F * kCells / size[axis];
  const auto cell = [&](float v) {
    return std::clamp(static_cast<int>(v * scale + 0.5F * kCells), 0, kCells - 1);
  };
  return {static_cast<std::size_t>(2 * axis + (p[axis] < 0 ? 1 : 0)), cell(p[(axis + 1) % 3]),
          cell(p[(axis + 2) % 3])};
}

}  // namespace

SeenThrough::SeenThrough(double range_sigma_m)
    : nearest_m_(6 * kFace, 0), margin_m_(static_cast<float>(0.1 + 4 * range_sigma_m)) {}

void SeenThrough::Add(const std::vector<Eigen::Vector3f>& points, std::size_t first) {
  for (std::size_t i = first; i < points.size(); ++i) {
    const Eigen::Vector3f& p = points[i];
    const float range = p.norm();
    if (!(range > 1e-3F)) continue;
    const Direction at = DirectionOf(p);
    float& nearest =
        nearest_m_[at.face * kFace + static_cast<std::size_t>(at.row * kCells + at.column)];
    if (nearest == 0 || range < nearest) nearest = range;
  }
}

void SeenThrough::Clear() { std::fill(nearest_m_.begin(), nearest_m_.end(), 0); }

bool SeenThrough::IsGone(const Eigen::Vector3f& place) const {
  constexpr float kBehind = 1.02F;
  const float range = place.norm();
  if (!(range > 1e-3F)) return false;
  const Direction at = DirectionOf(place);
  // All round, too: a scanner may be about to come to it.
  for (int row = at.row - 1; row <= at.row + 1; ++row) {
    for (int column = at.column - 1; column <= at.column + 1; ++column) {
      if (row < 0 || column < 0 || row >= kCells || column >= kCells) return false;
      const auto cell = static_cast<std::size_t>(row * kCells + column);
      if (nearest_m_[at.face * kFace + cell] < kBehind * range + margin_m_) return false;
    }
  }
  return true;
}

}  // namespace rgbdt
