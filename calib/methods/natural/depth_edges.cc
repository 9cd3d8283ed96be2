#include "calib/methods/natural/depth_edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>

#include "calib/detect/cloud/range_grid.h"
#include "calib/model/linear_algebra.h"

namespace rgbdt {
namespace {

using Eigen::Vector3d;

struct Step {
  int row, column;
};
constexpr std::array<Step, 4> kSteps{{{0, 1}, {0, -1}, {1, 0}, {-1, 0}}};

/// An edge and the cell of its nearer side.
struct Found {
  DepthEdge edge;
  int row, column;
  int step;  // of kSteps
};

class Finder {
 public:
  Finder(const RangeGrid& grid, const DepthEdgeOptions& options) : grid_(grid), options_(options) {
    ranges_.resize(static_cast<std::size_t>(grid.rows()) *
                   static_cast<std::size_t>(grid.columns()));
    for (std::size_t cell = 0; cell < ranges_.size(); ++cell) {
      ranges_[cell] =
          grid.IsHit(cell) ? (grid.Point(cell).cast<double>() - grid.Origin(cell)).norm() : 0;
    }
  }

  std::vector<Found> All() const {
    std::vector<Found> found;
    for (int row = 0; row < grid_.rows(); ++row) {
      for (int column = 0; column < grid_.columns(); ++column) {
        const double range = RangeAt(row, column);
        if (range < options_.min_range_m || range > options_.max_range_m) continue;
        for (int step = 0; step < static_cast<int>(kSteps.size()); ++step) {
          if (auto edge = EdgeAt(row, column, kSteps[static_cast<std::size_t>(step)])) {
            found.push_back({*edge, row, column, step});
          }
        }
      }
    }
    return found;
  }

 private:
  // 0: no hit, or no beam.
  double RangeAt(int row, int column) const {
    return grid_.Contains(row, column) ? ranges_[grid_.Cell(row, column)] : 0;
  }

  // The next beam that returned something, `most` steps away at most; where a grid was put together
  // from points, some cells are empty by chance.
  struct Beam {
    int row, column;
    double range;
    int steps;
  };
  std::optional<Beam> NextHit(int row, int column, const Step& step) const {
    constexpr int kMost = 3;
    for (int k = 1; k <= kMost; ++k) {
      const Beam beam{row + k * step.row, column + k * step.column, 0, k};
      const double range = RangeAt(beam.row, beam.column);
      if (range > 0) return Beam{beam.row, beam.column, range, k};
    }
    return std::nullopt;
  }

  // By how much the nearer surface's range grows from beam to beam up to its rim; nothing where it
  // does not go on evenly for two more beams: it is no surface.
  std::optional<double> SlopeOf(int row, int column, const Step& step, double range,
                                double jump) const {
    const Step back{-step.row, -step.column};
    const auto one = NextHit(row, column, back);
    if (!one) return std::nullopt;
    const auto two = NextHit(one->row, one->column, back);
    if (!two) return std::nullopt;
    const double near = (range - one->range) / one->steps;
    const double far = (one->range - two->range) / two->steps;
    if (std::abs(near) > 0.3 * std::min(jump, 3.0)) return std::nullopt;
    if (std::abs(near - far) > 0.05 + 0.02 * range) return std::nullopt;
    return (range - two->range) / (one->steps + two->steps);
  }

  // The share of a beam that the nearer surface must cover to be what is returned. Light falls off
  // with the square of range; before nothing a little is enough. The two beams at the rim may have
  // met both surfaces: those beside them tell how bright each is.
  double ShareThatReturns(int row, int column, const Step& step,
                          const std::optional<Beam>& beyond) const {
    constexpr double kEnough = 0.05;
    if (!beyond) return kEnough;
    double near_light = LightOf(row - step.row, column - step.column);
    if (near_light == 0) near_light = LightOf(row, column);
    double far_light = LightOf(beyond->row + step.row, beyond->column + step.column);
    if (far_light == 0) far_light = LightOf(beyond->row, beyond->column);
    return std::clamp(far_light / (near_light + far_light), kEnough, 1 - kEnough);
  }

  // 0: nothing.
  double LightOf(int row, int column) const {
    const double range = RangeAt(row, column);
    return range > 0 ? IntensityAt(grid_.Cell(row, column)) / (range * range) : 0;
  }

  // Of one point of the cell; unknown ones are all alike.
  double IntensityAt(std::size_t cell) const {
    double value = 1;
    if (grid_.cloud().intensity.empty()) return value;
    grid_.ForEachPoint(
        cell, [&](const Eigen::Vector3f&, std::size_t i) { value = grid_.cloud().intensity[i]; });
    return std::max(value, 0.01);
  }

  std::optional<DepthEdge> EdgeAt(int row, int column, const Step& step) const {
    if (!grid_.Contains(row + step.row, column + step.column)) return std::nullopt;
    const double range = RangeAt(row, column);
    const auto beyond = NextHit(row, column, step);
    const double least = options_.min_jump_m + options_.min_jump_ratio * range;
    if (beyond && beyond->range - range < least) return std::nullopt;
    const auto slope = SlopeOf(row, column, step, range, beyond ? beyond->range - range : 3.0);
    if (!slope) return std::nullopt;
    const int steps = beyond ? beyond->steps : 1;
    const std::size_t near = grid_.Cell(row, column);
    const std::size_t far = grid_.Cell(row + steps * step.row, column + steps * step.column);
    const auto direction = grid_.Direction(far);
    if (!direction) return std::nullopt;
    // A receding surface goes on to its rim, halfway to the next beam.
    const double rim = range + std::clamp(0.5 * steps * *slope, -0.3, 0.3);
    const Vector3d origin = grid_.Origin(near);
    const Vector3d last = origin + rim * (grid_.Point(near).cast<double>() - origin).normalized();
    const Vector3d past = grid_.Origin(far) + rim * *direction;
    DepthEdge edge;
    edge.point = 0.5 * (last + past);
    edge.across = 0.5 * (past - last);
    edge.kind = step.row != 0 ? DepthEdgeKind::kAcrossRows : DepthEdgeKind::kWithinRow;
    edge.reach = BeyondRim(ShareThatReturns(row, column, step, beyond));
    edge.place = step.row != 0 ? row : column;
    return edge;
  }

  const RangeGrid& grid_;
  const DepthEdgeOptions& options_;
  std::vector<double> ranges_;
};

/// How the rims run, by the edges beside each.
class Rims {
 public:
  Rims(const RangeGrid& grid, const std::vector<Found>& found, const DepthEdgeOptions& options)
      : grid_(grid), found_(found), options_(options) {
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
    const Found& own = found_[i];
    Vector3d sum = Vector3d::Zero();
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
    int count = 0;
    ForEachNeighbour(own, [&](std::size_t j) {
      const DepthEdge& other = found_[j].edge;
      // The other side of a thin thing is another rim.
      if (other.across.dot(own.edge.across) < 0 && SameDirection(own, found_[j])) return;
      const Vector3d apart = other.point - own.edge.point;
      sum += apart;
      squares += apart * apart.transpose();
      ++count;
    });
    if (count < options_.min_neighbours) return std::nullopt;
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
    if (rough > options_.max_roughness * options_.max_roughness * most) return std::nullopt;
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
  static bool SameDirection(const Found& a, const Found& b) {
    return (kSteps[static_cast<std::size_t>(a.step)].row == 0) ==
           (kSteps[static_cast<std::size_t>(b.step)].row == 0);
  }

  // Edges in the cells about it, at about its range; it is one of them.
  template <typename F>
  void ForEachNeighbour(const Found& own, F f) const {
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
  const std::vector<Found>& found_;
  const DepthEdgeOptions& options_;
  std::vector<int> first_, next_;  // by cell, by edge: the edges of a cell; -1: none
  int rows_ = 0, columns_ = 0;
};

}  // namespace

double BeyondRim(double share) {
  double low = -1;
  double high = 1;
  for (int i = 0; i < 40; ++i) {
    const double d = 0.5 * (low + high);
    (std::acos(d) - d * std::sqrt(1 - d * d) > M_PI * share ? low : high) = d;
  }
  return 0.5 * (low + high);
}

std::vector<DepthEdge> FindDepthEdges(const Cloud& cloud, const DepthEdgeOptions& options) {
  const RangeGrid grid(cloud);
  const std::vector<Found> found = Finder(grid, options).All();
  const Rims rims(grid, found, options);
  const std::vector<int> things = rims.Numbers(false);
  const std::vector<int> numbers = rims.Numbers(true);
  // How bright surfaces are changes less along a rim than single beams' intensities say: with those
  // the beam's width, as a regression on what is noisy, would come out too small.
  std::vector<double> reach(found.size(), 0), count(found.size(), 0);
  for (std::size_t i = 0; i < found.size(); ++i) {
    reach[static_cast<std::size_t>(numbers[i])] += found[i].edge.reach;
    count[static_cast<std::size_t>(numbers[i])] += 1;
  }
  std::vector<DepthEdge> edges;
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
