#pragma once

#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "calib/detect/image/internal/saddles.h"

namespace rgbdt {

/// Saddles by row and column: (column, row) -> place [px]. Columns and rows count from an arbitrary
/// one; both may be negative.
using CornerGrid = std::map<std::pair<int, int>, Eigen::Vector2d>;

/// The grids that can be grown among the saddles of one image. Each begins at a saddle whose edges
/// point to neighbours with light and dark exchanged, and takes in what lies where its members say
/// that the next one is. `largest`: columns and rows a grid may span.
class GridFinder {
 public:
  GridFinder(const std::vector<Saddle>& saddles, int largest);

  /// The next grid of at least `least` saddles, the most regular beginnings first; nothing when
  /// there is none left. A saddle is given out once.
  std::optional<CornerGrid> Next(std::size_t least);

 private:
  struct Seed {
    double irregularity = 0;
    int saddle = -1;
    Eigen::Vector2d right{0, 0}, down{0, 0};  ///< to the next saddle [px]
  };
  using Members = std::map<std::pair<int, int>, int>;

  /// Calls `visit(index)` for each saddle nearer than `radius` [px].
  template <typename Visit>
  void ForEachNear(const Eigen::Vector2d& place, double radius, const Visit& visit) const;
  int NeighbourAlong(int from, double angle) const;
  std::optional<Seed> SeedAt(int index) const;
  int SaddleAt(const Eigen::Vector2d& place, double radius, const Saddle& like, double sign,
               const std::vector<char>& taken) const;
  Members Grow(const Seed& seed) const;

  const std::vector<Saddle>& saddles_;
  int largest_;
  int columns_ = 0, rows_ = 0;          ///< of bins
  std::vector<std::vector<int>> bins_;  ///< saddles by place
  std::vector<Seed> seeds_;
  std::size_t next_seed_ = 0;
  std::vector<char> used_;
};

}  // namespace rgbdt
