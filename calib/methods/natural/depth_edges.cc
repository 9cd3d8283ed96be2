#include "calib/methods/natural/depth_edges.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "calib/methods/natural/internal/rims.h"

namespace rgbdt {
namespace {

using Eigen::Vector3d;

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

  std::vector<FoundEdge> All() const {
    std::vector<FoundEdge> found;
    for (int row = 0; row < grid_.rows(); ++row) {
      for (int column = 0; column < grid_.columns(); ++column) {
        const double range = RangeAt(row, column);
        if (range < options_.min_range_m || range > options_.max_range_m) continue;
        for (int step = 0; step < static_cast<int>(kScanSteps.size()); ++step) {
          if (auto edge = EdgeAt(row, column, kScanSteps[static_cast<std::size_t>(step)])) {
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
  std::optional<Beam> NextHit(int row, int column, const ScanStep& step) const {
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
  std::optional<double> SlopeOf(int row, int column, const ScanStep& step, double range,
                                double jump) const {
    const ScanStep back{-step.row, -step.column};
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
  double ShareThatReturns(int row, int column, const ScanStep& step,
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

  std::optional<SceneEdge> EdgeAt(int row, int column, const ScanStep& step) const {
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
    SceneEdge edge;
    edge.point = 0.5 * (last + past);
    edge.across = 0.5 * (past - last);
    edge.kind = step.row != 0 ? SceneEdgeKind::kDepthAcrossRows : SceneEdgeKind::kDepthWithinRow;
    edge.reach = BeyondRim(ShareThatReturns(row, column, step, beyond));
    edge.place = step.row != 0 ? row : column;
    return edge;
  }

  const RangeGrid& grid_;
  const DepthEdgeOptions& options_;
  std::vector<double> ranges_;
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

std::vector<SceneEdge> FindDepthEdges(const RangeGrid& grid, const DepthEdgeOptions& options) {
  return WithRims(grid, Finder(grid, options).All());
}

}  // namespace rgbdt
