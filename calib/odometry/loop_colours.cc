#include "calib/odometry/loop_colours.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>

namespace rgbdt {
namespace {

constexpr double kCell = 0.4;                          // [m]
constexpr double kNear = 10;                           // [m] from a place: what was seen there
constexpr Utime kAbout = 20 * kMicrosecondsPerSecond;  // likewise
constexpr float kMostRange = 25;                       // [m] a pixel is wide beyond
constexpr std::size_t kFewestCells = 60;
// Colours of one place correlate by 0.5 and more, those of two by hardly anything.
constexpr double kAlike = 0.5, kUnlike = 0.1, kMostFactor = 100;

constexpr std::size_t kKinds = 2;  // brightness, temperature

struct Sum {
  std::array<double, kKinds> value{};
  std::array<int, kKinds> count{};
};

using Cell = std::tuple<int, int, int>;
using Cells = std::map<Cell, Sum>;

// Pearson's, of pairs less the mean of their own height.
class Correlation {
 public:
  void Add(int height, double a, double b) { pairs_[height].push_back({a, b}); }

  ColoursAlike Get() const {
    ColoursAlike alike;
    double aa = 0, bb = 0, ab = 0;
    for (const auto& [height, pairs] : pairs_) {
      Eigen::Vector2d mean = Eigen::Vector2d::Zero();
      for (const Eigen::Vector2d& pair : pairs) mean += pair / static_cast<double>(pairs.size());
      for (const Eigen::Vector2d& pair : pairs) {
        const Eigen::Vector2d off = pair - mean;
        aa += off[0] * off[0];
        bb += off[1] * off[1];
        ab += off[0] * off[1];
      }
      alike.cells += pairs.size();
    }
    // A place without any contrast tells nothing.
    if (aa * bb > 0) {
      alike.correlation = ab / std::sqrt(aa * bb);
    } else {
      alike.cells = 0;
    }
    return alike;
  }

 private:
  std::map<int, std::vector<Eigen::Vector2d>> pairs_;
};

}  // namespace

void LoopColours::Add(const RgbdtCloud& fused) {
  if (!fused.map_from_lidar || !fused.whole_sweep) return;
  const Rigid3& pose = *fused.map_from_lidar;
  const bool same = !sweeps_.empty() && sweeps_.back().sweep_utime == fused.sweep_utime;
  const bool near = !sweeps_.empty() && (sweeps_.back().at - pose.translation).norm() < apart_m_;
  if (near && !same) return;
  std::vector<std::size_t> seen;
  for (std::size_t i = 0; i < fused.size(); ++i) {
    const auto& rgb = fused.rgb[i];
    const bool coloured = rgb[0] != 0 || rgb[1] != 0 || rgb[2] != 0;
    if (!coloured && std::isnan(fused.temperature_k[i])) continue;
    if (fused.points[i].norm() < kMostRange) seen.push_back(i);
  }
  if (seen.empty()) return;
  if (!same) sweeps_.push_back({fused.sweep_utime, fused.frame_utime, pose.translation, {}});
  std::vector<Point>& points = sweeps_.back().points;
  const std::size_t step = (seen.size() + kMostPoints - 1) / kMostPoints;
  for (std::size_t k = 0; k < seen.size() && points.size() < 4 * kMostPoints; k += step) {
    const std::size_t i = seen[k];
    const auto& rgb = fused.rgb[i];
    const float grey = static_cast<float>(rgb[0] + rgb[1] + rgb[2]) / 3;
    const Eigen::Vector3d in_world = pose * fused.points[i].cast<double>();
    points.push_back({in_world.cast<float>(), grey > 0 ? grey : NAN, fused.temperature_k[i]});
  }
  if (sweeps_.size() < kMostSweeps) return;
  for (std::size_t i = 0; 2 * i < sweeps_.size(); ++i) {
    if (i > 0) sweeps_[i] = std::move(sweeps_[2 * i]);
  }
  sweeps_.resize((sweeps_.size() + 1) / 2);
  apart_m_ *= 2;
}

ColoursAlike LoopColours::Compare(const Pair& pair) const {
  const Utime about = std::min(kAbout, std::abs(pair.new_utime - pair.old_utime) / 2);
  const auto cells_at = [&](Utime utime, const Rigid3& world_from_place, const Rigid3& to_old) {
    Cells cells;
    const Rigid3 old_from_world = to_old * world_from_place.Inverse();
    for (const Sweep& sweep : sweeps_) {
      if (std::abs(sweep.utime - utime) > about) continue;
      if ((sweep.at - world_from_place.translation).norm() > kNear) continue;
      for (const Point& point : sweep.points) {
        const Eigen::Vector3d at = (old_from_world * point.in_world.cast<double>()) / kCell;
        Sum& sum =
            cells[{static_cast<int>(std::floor(at.x())), static_cast<int>(std::floor(at.y())),
                   static_cast<int>(std::floor(at.z()))}];
        const std::array<float, kKinds> values{point.brightness, point.temperature_k};
        for (std::size_t kind = 0; kind < kKinds; ++kind) {
          if (std::isnan(values[kind])) continue;
          sum.value[kind] += values[kind];
          ++sum.count[kind];
        }
      }
    }
    return cells;
  };
  const Cells old_cells = cells_at(pair.old_utime, pair.world_from_old, {});
  const Cells new_cells = cells_at(pair.new_utime, pair.world_from_new, pair.old_from_new);
  ColoursAlike alike;
  for (std::size_t kind = 0; kind < kKinds; ++kind) {
    Correlation correlation;
    for (const auto& [cell, a] : old_cells) {
      const auto found = new_cells.find(cell);
      if (found == new_cells.end()) continue;
      const Sum& b = found->second;
      if (a.count[kind] == 0 || b.count[kind] == 0) continue;
      correlation.Add(std::get<2>(cell), a.value[kind] / a.count[kind],
                      b.value[kind] / b.count[kind]);
    }
    const ColoursAlike one = correlation.Get();
    if (one.cells < kFewestCells) continue;
    alike.correlation += static_cast<double>(one.cells) * one.correlation;
    alike.cells += one.cells;
  }
  if (alike.cells > 0) alike.correlation /= static_cast<double>(alike.cells);
  return alike;
}

double LoopColours::SigmaFactor(const ColoursAlike& alike) {
  if (alike.cells == 0) return 1;
  const double unlike = (kAlike - alike.correlation) / (kAlike - kUnlike);
  return std::pow(kMostFactor, std::min(1.0, std::max(0.0, unlike)));
}

}  // namespace rgbdt
