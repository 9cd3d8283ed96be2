#include "calib/terrain/internal/ground.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <functional>
#include <limits>
#include <opencv2/imgproc.hpp>

namespace rgbdt::terrain {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr double kDegree = 3.14159265358979323846 / 180;

using Marks = std::vector<std::uint8_t>;
using Component = std::vector<std::size_t>;

/// How far two heights of the ground may differ at a distance [m].
struct Tolerance {
  double at_once_m, slope;
  bool Fits(double difference_m, double distance_m) const {
    return std::abs(difference_m) <= at_once_m + slope * distance_m;
  }
};

double Distance(const TerrainGrid& grid, int dc, int dr) {
  return grid.cell_m * std::hypot(dc, dr);
}

// Cells whose lowest height some neighbours share: a ghost below the ground stands alone.
Marks Supported(const std::vector<float>& lowest, const TerrainGrid& grid,
                const Tolerance& tolerance) {
  Marks supported(lowest.size(), 0);
  for (std::size_t cell = 0; cell < lowest.size(); ++cell) {
    if (!std::isfinite(lowest[cell])) continue;
    int support = 0;
    VisitAround(grid, cell, 2, [&](std::size_t other, int dc, int dr) {
      support += std::isfinite(lowest[other]) &&
                 tolerance.Fits(lowest[other] - lowest[cell], Distance(grid, dc, dr));
    });
    supported[cell] = support >= 3;
  }
  return supported;
}

// The lower envelope of cones, apex on each supported cell's height, rising with `slope`: the
// filter of Vosselman (2000), by two passes of a chamfer distance each way.
std::vector<float> ConeEnvelope(const std::vector<float>& lowest, const Marks& supported,
                                const TerrainGrid& grid, double slope) {
  std::vector<float> envelope(lowest.size(), std::numeric_limits<float>::infinity());
  for (std::size_t cell = 0; cell < lowest.size(); ++cell) {
    if (supported[cell]) envelope[cell] = lowest[cell];
  }
  const auto relax = [&](int column, int row) {
    const std::size_t cell = grid.Index(column, row);
    VisitAround(grid, cell, 1, [&](std::size_t other, int dc, int dr) {
      envelope[cell] = std::min(
          envelope[cell], envelope[other] + static_cast<float>(slope * Distance(grid, dc, dr)));
    });
  };
  for (int pass = 0; pass < 2; ++pass) {
    for (int row = 0; row < grid.rows; ++row) {
      for (int column = 0; column < grid.columns; ++column) relax(column, row);
    }
    for (int row = grid.rows - 1; row >= 0; --row) {
      for (int column = grid.columns - 1; column >= 0; --column) relax(column, row);
    }
  }
  return envelope;
}

// Grows `marks` from `queue` over cells that `may` join and fit their neighbour.
void Grow(const std::vector<float>& lowest, const Marks& may, const TerrainGrid& grid,
          const Tolerance& tolerance, int reach, std::deque<std::size_t> queue, Marks* marks,
          Component* grown) {
  while (!queue.empty()) {
    const std::size_t cell = queue.front();
    queue.pop_front();
    if (grown != nullptr) grown->push_back(cell);
    VisitAround(grid, cell, reach, [&](std::size_t other, int dc, int dr) {
      if ((*marks)[other] || !may[other]) return;
      if (!tolerance.Fits(lowest[other] - lowest[cell], Distance(grid, dc, dr))) return;
      (*marks)[other] = 1;
      queue.push_back(other);
    });
  }
}

std::vector<Component> Components(const std::vector<float>& lowest, const Marks& candidates,
                                  const TerrainGrid& grid, const Tolerance& tolerance) {
  std::vector<Component> components;
  Marks done(candidates.size(), 0);
  for (std::size_t cell = 0; cell < candidates.size(); ++cell) {
    if (!candidates[cell] || done[cell]) continue;
    done[cell] = 1;
    components.emplace_back();
    Grow(lowest, candidates, grid, tolerance, 2, {cell}, &done, &components.back());
  }
  std::stable_sort(components.begin(), components.end(),
                   [](const Component& a, const Component& b) { return a.size() > b.size(); });
  return components;
}

// Whether a piece of ground that is cut off may belong to the rest: near enough, and neither a
// ceiling above it nor the top of a table.
bool MayJoin(const Component& component, const std::vector<float>& lowest, const Nearest& nearest,
             const TerrainGrid& grid, const TerrainOptions& options) {
  constexpr double kMaxGap = 3, kPlateau = 4;  // [m], [m^2]
  const Tolerance tolerance{3 * options.max_step_m, std::tan(20 * kDegree)};
  const auto closest = std::min_element(
      component.begin(), component.end(),
      [&](std::size_t a, std::size_t b) { return nearest.distance_m[a] < nearest.distance_m[b]; });
  const double gap = nearest.distance_m[*closest];
  const double rise = lowest[*closest] - lowest[static_cast<std::size_t>(nearest.cell[*closest])];
  if (gap > kMaxGap) return false;
  const double area = static_cast<double>(component.size()) * grid.cell_m * grid.cell_m;
  return tolerance.Fits(rise, gap) || (area >= kPlateau && rise < options.vehicle_height_m);
}

}  // namespace

double GroundSlope(const TerrainOptions& options) { return options.max_slope_rad + 10 * kDegree; }

std::vector<float> LowestHeights(const Cells& cells, const TerrainGrid& grid,
                                 const TerrainOptions& options) {
  std::vector<float> lowest(grid.size(), kNan);
  for (std::size_t cell = 0; cell < grid.size(); ++cell) {
    const Span points = cells[cell];
    std::size_t count = 0;
    for (const CellPoint& point : points) count += point.count;
    if (count < static_cast<std::size_t>(options.min_points)) continue;
    const std::size_t rank = points.size() < 3 ? 0 : std::max<std::size_t>(1, points.size() / 10);
    lowest[cell] = points.first[rank].z;
  }
  return lowest;
}

Nearest NearestMarked(const Marks& marked, const TerrainGrid& grid) {
  Nearest nearest;
  nearest.cell.assign(grid.size(), -1);
  nearest.distance_m.assign(grid.size(), std::numeric_limits<float>::infinity());
  if (std::find(marked.begin(), marked.end(), 1) == marked.end()) return nearest;
  cv::Mat_<unsigned char> image(grid.rows, grid.columns);
  std::transform(marked.begin(), marked.end(), image.begin(),
                 [](std::uint8_t mark) { return static_cast<unsigned char>(mark ? 0 : 255); });
  cv::Mat_<float> distance;
  cv::Mat_<int> label;
  cv::distanceTransform(image, distance, label, cv::DIST_L2, cv::DIST_MASK_5, cv::DIST_LABEL_PIXEL);
  std::vector<std::int64_t> cell_of_label(grid.size() + 1, -1);
  for (std::size_t cell = 0; cell < grid.size(); ++cell) {
    const int of_cell = *(label.begin() + static_cast<std::ptrdiff_t>(cell));
    if (marked[cell]) {
      cell_of_label[static_cast<std::size_t>(of_cell)] = static_cast<std::int64_t>(cell);
    }
  }
  for (std::size_t cell = 0; cell < grid.size(); ++cell) {
    const auto at = static_cast<std::ptrdiff_t>(cell);
    nearest.cell[cell] = cell_of_label[static_cast<std::size_t>(*(label.begin() + at))];
    nearest.distance_m[cell] = *(distance.begin() + at) * static_cast<float>(grid.cell_m);
  }
  return nearest;
}

Marks FindGround(const std::vector<float>& lowest, const TerrainGrid& grid,
                 const TerrainOptions& options) {
  const double slope = std::tan(GroundSlope(options));
  const Tolerance step{options.max_step_m, slope};
  const Marks supported = Supported(lowest, grid, step);
  const std::vector<float> envelope = ConeEnvelope(lowest, supported, grid, slope);
  Marks candidates(grid.size(), 0), may(grid.size(), 0);
  for (std::size_t cell = 0; cell < grid.size(); ++cell) {
    may[cell] = std::isfinite(lowest[cell]);
    candidates[cell] = supported[cell] && lowest[cell] - envelope[cell] <= options.max_step_m;
  }
  std::vector<Component> left = Components(lowest, candidates, grid, step);
  Marks ground(grid.size(), 0);
  if (left.empty()) return ground;
  for (const std::size_t cell : left.front()) ground[cell] = 1;
  left.erase(left.begin());
  for (bool joined = true; joined && !left.empty();) {
    const Nearest nearest = NearestMarked(ground, grid);
    const auto joins = [&](const Component& component) {
      return MayJoin(component, lowest, nearest, grid, options);
    };
    const auto rest = std::stable_partition(left.begin(), left.end(), std::not_fn(joins));
    joined = rest != left.end();
    for (auto component = rest; component != left.end(); ++component) {
      for (const std::size_t cell : *component) ground[cell] = 1;
    }
    left.erase(rest, left.end());
  }
  // What the cones cut off round a drop, a step at a time.
  std::deque<std::size_t> queue;
  for (std::size_t cell = 0; cell < grid.size(); ++cell) {
    if (ground[cell]) queue.push_back(cell);
  }
  Grow(lowest, may, grid, {0.75 * options.max_step_m, slope}, 1, std::move(queue), &ground,
       nullptr);
  return ground;
}

}  // namespace rgbdt::terrain
