#include "calib/methods/natural/internal/rims.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "calib/model/linear_algebra.h"

namespace rgbdt {
namespace {

using Eigen::Vector3d;

constexpr int kFewestNeighbours = 4;  // edges that tell how the rim runs
constexpr double kMostRough = 0.3;    // of the neighbours' spread: aside of the rim over along it

/// How the rims run, by the edges beside each.
class Rims {
 public:
  Rims(const RangeGrid& grid, const std::vector<FoundEdge>& found) : grid_(grid), found_(found) {
    first_.assign(static_cast<std::size_t>(grid.rows()) * static_cast<std::size_t>(grid.columns()),
                  -1);
    next_.assign(found.size(), -1);
    for (std::size_t i = found.size(); i-- > 0;) {
      auto& first = first_[grid.Cell(found[i].row, found[i].column)];
      next_[i] = first;
      first = static_cast<int>(i);
    }
    const double row = grid.row_step();
    const double column = grid.column_step();
    const double window = std::max(4 * std::min(row, column), 2.2 * std::max(row, column));
    rows_ = row > 0 ? std::clamp(static_cast<int>(std::ceil(window / row)), 1, 20) : 0;
    columns_ = column > 0 ? std::clamp(static_cast<int>(std::ceil(window / column)), 1, 40) : 0;
  }

  /// Nothing where the neighbours form no rim.
  std::optional<Vector3d> Along(std::size_t i) const {
    const FoundEdge& own = found_[i];
    Vector3d sum = Vector3d::Zero();
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
    int count = 0;
    ForEachNeighbour(own, [&](std::size_t j) {
      const SceneEdge& other = found_[j].edge;
      // The other side of a thin thing is another rim.
      if (other.across.dot(own.edge.across) < 0 && SameDirection(own, found_[j])) return;
      const Vector3d apart = other.point - own.edge.point;
      sum += apart;
      squares += apart * apart.transpose();
      ++count;
    });
    if (count < kFewestNeighbours) return std::nullopt;
    const Vector3d sight = own.edge.point.normalized();
    const Eigen::Matrix3d aside = Eigen::Matrix3d::Identity() - sight * sight.transpose();
    const Vector3d mean = sum / count;
    const Eigen::Matrix3d scatter = aside * (squares / count - mean * mean.transpose()) * aside;
    const auto system = EigensystemOf(scatter);
    const double most = system.values[2];
    if (!(most > 0)) return std::nullopt;
    // What the beams' spacing alone makes of a straight rim is no roughness.
    const double spacing = own.edge.across.squaredNorm() / 3;
    const double rough = std::max(0.0, system.values[1] - spacing);
    if (rough > kMostRough * kMostRough * most) return std::nullopt;
    return system.vectors.col(2);
  }

  /// Numbers of connected edges, by edge; `same_step`: of those met in one direction alone.
  std::vector<int> Numbers(bool same_step) const {
    std::vector<int> root(found_.size());
    std::iota(root.begin(), root.end(), 0);
    const auto find = [&](int i) {
      while (root[static_cast<std::size_t>(i)] != i) {
        int& next = root[static_cast<std::size_t>(i)];
        next = root[static_cast<std::size_t>(next)];
        i = next;
      }
      return i;
    };
    for (std::size_t i = 0; i < found_.size(); ++i) {
      ForEachNeighbour(found_[i], [&](std::size_t j) {
        if (same_step && found_[j].step != found_[i].step) return;
        const int a = find(static_cast<int>(i));
        const int b = find(static_cast<int>(j));
        root[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
      });
    }
    for (std::size_t i = 0; i < found_.size(); ++i) root[i] = find(static_cast<int>(i));
    return root;
  }

 private:
  static bool SameDirection(const FoundEdge& a, const FoundEdge& b) {
    return (kScanSteps[static_cast<std::size_t>(a.step)].row == 0) ==
           (kScanSteps[static_cast<std::size_t>(b.step)].row == 0);
  }

  // Edges in the cells about it, at about its range; it is one of them.
  template <typename F>
  void ForEachNeighbour(const FoundEdge& own, F f) const {
    const double range = own.edge.point.norm();
    for (int row = own.row - rows_; row <= own.row + rows_; ++row) {
      for (int column = own.column - columns_; column <= own.column + columns_; ++column) {
        if (!grid_.Contains(row, column)) continue;
        for (int j = first_[grid_.Cell(row, column)]; j >= 0;
             j = next_[static_cast<std::size_t>(j)]) {
          const auto at = static_cast<std::size_t>(j);
          const double apart = std::abs(found_[at].edge.point.norm() - range);
          if (apart <= 0.1 + 0.04 * range) f(at);
        }
      }
    }
  }

  const RangeGrid& grid_;
  const std::vector<FoundEdge>& found_;
  std::vector<int> first_, next_;  // by cell, by edge: the edges of a cell; -1: none
  int rows_ = 0, columns_ = 0;
};

}  // namespace

std::vector<SceneEdge> WithRims(const RangeGrid& grid, const std::vector<FoundEdge>& found) {
  const Rims rims(grid, found);
  const std::vector<int> things = rims.Numbers(false);
  const std::vector<int> numbers = rims.Numbers(true);
  // How bright surfaces are changes less along a rim than single beams' intensities say: with those
  // the beam's width, as a regression on what is noisy, would come out too small.
  std::vector<double> reach(found.size(), 0), count(found.size(), 0);
  for (std::size_t i = 0; i < found.size(); ++i) {
    reach[static_cast<std::size_t>(numbers[i])] += found[i].edge.reach;
    count[static_cast<std::size_t>(numbers[i])] += 1;
  }
  std::vector<SceneEdge> edges;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const auto along = rims.Along(i);
    if (!along) continue;
    edges.push_back(found[i].edge);
    edges.back().along = *along;
    edges.back().thing = things[i];
    edges.back().rim = numbers[i];
    const auto rim = static_cast<std::size_t>(numbers[i]);
    edges.back().reach = reach[rim] / count[rim];
  }
  return edges;
}

}  // namespace rgbdt
