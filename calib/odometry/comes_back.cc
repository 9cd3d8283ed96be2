#include "calib/odometry/comes_back.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <map>

namespace rgbdt {
namespace {

constexpr double kNear = 10, kLong = 50, kStep = 1;  // [m]

// Places by cells as large as what counts as near. Few get into one cell: a way that fills it comes
// back to it.
class Cells {
 public:
  void Add(const Eigen::Vector3d& place) { cells_[CellOf(place, 0, 0, 0)].push_back(place); }

  bool HasNear(const Eigen::Vector3d& place) const {
    for (int x = -1; x <= 1; ++x) {
      for (int y = -1; y <= 1; ++y) {
        for (int z = -1; z <= 1; ++z) {
          const auto cell = cells_.find(CellOf(place, x, y, z));
          if (cell == cells_.end()) continue;
          for (const Eigen::Vector3d& other : cell->second) {
            if ((other - place).norm() < kNear) return true;
          }
        }
      }
    }
    return false;
  }

 private:
  using Cell = std::array<double, 3>;  // whole numbers, of which an int might not hold all

  static Cell CellOf(const Eigen::Vector3d& place, int x, int y, int z) {
    return {std::floor(place.x() / kNear) + x, std::floor(place.y() / kNear) + y,
            std::floor(place.z() / kNear) + z};
  }

  std::map<Cell, std::vector<Eigen::Vector3d>> cells_;
};

}  // namespace

bool ComesBack(const std::vector<Eigen::Vector3d>& places) {
  std::vector<Eigen::Vector3d> kept;
  std::vector<double> ways;  // to each
  Cells cells;               // of the first `past`, which lie long before
  std::size_t past = 0;
  double way = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (!places[i].allFinite()) return false;  // no way goes on from there
    if (i > 0) way += (places[i] - places[i - 1]).norm();
    if (!ways.empty() && way - ways.back() < kStep) continue;
    for (; past < kept.size() && way - ways[past] > kLong; ++past) cells.Add(kept[past]);
    if (cells.HasNear(places[i])) return true;
    kept.push_back(places[i]);
    ways.push_back(way);
  }
  return false;
}

}  // namespace rgbdt
