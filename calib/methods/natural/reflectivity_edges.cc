#include "calib/methods/natural/reflectivity_edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include "calib/methods/natural/internal/rims.h"
#include "calib/model/statistics.h"

namespace rgbdt {
namespace {

using Eigen::Vector3d;

constexpr double kNearestM = 0.5, kFarthestM = 60;  // nearer is the rig itself
constexpr double kLeastContrast = 0.2;  // of the two levels: their difference over their sum
constexpr double kLeastSigmas = 8;      // of their difference, by the noise of one intensity

/// Four beams in a row, the rim between the second and the third.
struct Line {
  std::array<std::size_t, 4> cells;
  std::array<double, 4> light;
};

class Finder {
 public:
  explicit Finder(const RangeGrid& grid) : grid_(grid) {
    const auto cells =
        static_cast<std::size_t>(grid.rows()) * static_cast<std::size_t>(grid.columns());
    range_.resize(cells);
    light_.resize(cells);
    for (std::size_t cell = 0; cell < cells; ++cell) {
      if (!grid.IsHit(cell)) continue;
      range_[cell] = (grid.Point(cell).cast<double>() - grid.Origin(cell)).norm();
      grid.ForEachPoint(cell, [&](const Eigen::Vector3f&, std::size_t i) {
        light_[cell] = std::max(0.0F, grid.cloud().intensity[i]);
      });
    }
    LevelRows();
    sigma_ = NoiseOfLight();
  }

  std::vector<FoundEdge> All() const {
    std::vector<FoundEdge> found;
    for (int row = 0; row < grid_.rows(); ++row) {
      for (int column = 0; column < grid_.columns(); ++column) {
        for (const int step : {0, 2}) {
          const auto line = LineAt(row, column, kScanSteps[static_cast<std::size_t>(step)]);
          if (line) AddEdge(*line, row, column, step, &found);
        }
      }
    }
    return found;
  }

 private:
  // The beams about (row, column) and the next one, on a surface that goes on evenly.
  std::optional<Line> LineAt(int row, int column, const ScanStep& step) const {
    Line line;
    for (int k = 0; k < 4; ++k) {
      const int r = row + (k - 1) * step.row, c = column + (k - 1) * step.column;
      if (!grid_.Contains(r, c)) return std::nullopt;
      const std::size_t cell = grid_.Cell(r, c);
      if (range_[cell] < kNearestM || range_[cell] > kFarthestM) return std::nullopt;
      line.cells[static_cast<std::size_t>(k)] = cell;
      line.light[static_cast<std::size_t>(k)] = light_[cell];
    }
    const auto range = [&](std::size_t k) { return range_[line.cells[k]]; };
    const double uneven = 0.03 + 0.005 * range(1);
    for (std::size_t k = 1; k < 3; ++k) {
      if (std::abs(range(k - 1) - 2 * range(k) + range(k + 1)) > uneven) return std::nullopt;
    }
    const double apart = (PointOf(line.cells[2]) - PointOf(line.cells[1])).norm();
    if (std::abs(range(2) - range(1)) > 0.8 * apart) return std::nullopt;  // seen too aslant
    return line;
  }

  Vector3d PointOf(std::size_t cell) const { return grid_.Point(cell).cast<double>(); }

  // Rows made equally bright: by what neighbours on one surface differ by, in the middle.
  void LevelRows() {
    double gain = 1;
    for (int row = 1; row < grid_.rows(); ++row) {
      std::vector<double> ratios;
      for (int column = 0; column < grid_.columns(); ++column) {
        const std::size_t before = grid_.Cell(row - 1, column), own = grid_.Cell(row, column);
        if (!(light_[before] > 0) || !(light_[own] > 0)) continue;
        if (std::abs(range_[own] - range_[before]) > 0.1 * range_[own]) continue;
        // That one is levelled already.
        ratios.push_back(std::log(light_[before] / light_[own]));
      }
      constexpr std::size_t kFew = 20;
      if (ratios.size() >= kFew) gain = std::exp(Median(std::move(ratios)));
      for (int column = 0; column < grid_.columns(); ++column) {
        light_[grid_.Cell(row, column)] *= static_cast<float>(gain);
      }
    }
  }

  // 1 sigma of one beam's, from where surfaces go on: of three beams' curvature, sqrt(6) times.
  double NoiseOfLight() const {
    std::vector<double> curved;
    for (int row = 0; row < grid_.rows(); ++row) {
      for (int column = 0; column < grid_.columns(); ++column) {
        const auto line = LineAt(row, column, kScanSteps[0]);
        if (!line) continue;
        curved.push_back(std::abs(line->light[0] - 2 * line->light[1] + line->light[2]));
      }
    }
    return curved.empty() ? 0 : 1.4826 * Median(std::move(curved)) / std::sqrt(6.0);
  }

  void AddEdge(const Line& line, int row, int column, int step,
               std::vector<FoundEdge>* found) const {
    const auto& light = line.light;
    const double jump = std::abs(light[1] - light[2]);
    const double difference = std::abs(light[0] - light[3]), sum = light[0] + light[3];
    if (!(difference > kLeastContrast * sum) || difference < kLeastSigmas * sigma_) return;
    const double before = std::abs(light[0] - light[1]), after = std::abs(light[2] - light[3]);
    // Where it is steepest, once.
    if (jump <= before || jump < after || before + after > 1.2 * difference) return;
    // How many beams of the two in the middle the first level fills.
    const double filled = (light[1] + light[2] - 2 * light[3]) / (light[0] - light[3]);
    if (!(filled > 0.4 && filled < 1.6)) return;
    const bool first_brighter = light[0] > light[3];
    const Vector3d from = PointOf(line.cells[1]), to = PointOf(line.cells[2]);
    FoundEdge one;
    one.edge.point = from + (filled - 0.5) * (to - from);
    one.edge.across = (first_brighter ? 0.5 : -0.5) * (to - from);
    one.edge.kind = SceneEdgeKind::kReflectivity;
    one.edge.place = step == 0 ? column : row;
    const ScanStep& go = kScanSteps[static_cast<std::size_t>(step)];
    one.row = first_brighter ? row : row + go.row;
    one.column = first_brighter ? column : column + go.column;
    one.step = first_brighter ? step : step + 1;
    found->push_back(one);
  }

  const RangeGrid& grid_;
  std::vector<double> range_;  // by cell; 0: no hit
  std::vector<float> light_;   // by cell; 0: none
  double sigma_ = 0;
};

}  // namespace

std::vector<SceneEdge> FindReflectivityEdges(const RangeGrid& grid) {
  if (grid.cloud().intensity.empty()) return {};
  return WithRims(grid, Finder(grid).All());
}

}  // namespace rgbdt
