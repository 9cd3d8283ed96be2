#include "calib/fuse/point_spacing.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace rgbdt {
namespace {

constexpr double kLeastPx = 0.05;   // of the histogram's first bin
constexpr double kBinRatio = 1.17;  // of the next one: 64 bins end at 1000 px
constexpr double kCell = 1.1;       // of the spacing
constexpr double kMostCells = 480;  // along the image's width: finer ones cost more than they tell

// Steps of a grid of points as the shortest ones that lead to the same points (Lagrange and Gauss):
// an Ouster's rings are staggered, so that the next beam, or that of the next line, may lie far
// off.
void Shorten(Eigen::Vector2d* a, Eigen::Vector2d* b) {
  constexpr int kMostRounds = 10;
  for (int round = 0; round < kMostRounds; ++round) {
    Eigen::Vector2d* const longer = a->squaredNorm() > b->squaredNorm() ? a : b;
    const Eigen::Vector2d& shorter = longer == a ? *b : *a;
    const double times = std::round(longer->dot(shorter) / shorter.squaredNorm());
    if (!(std::abs(times) >= 1) || !std::isfinite(times)) return;
    *longer -= times * shorter;
  }
}

}  // namespace

void PointSpacing::Histogram::Add(double distance_px) {
  const double bin = std::log(std::max(kLeastPx, distance_px) / kLeastPx) / std::log(kBinRatio);
  ++bins_[static_cast<std::size_t>(std::min(63.0, bin))];
  ++count_;
}

double PointSpacing::Histogram::Median() const {
  int below = 0;
  for (std::size_t i = 0; i < bins_.size(); ++i) {
    below += bins_[i];
    if (2 * below > count_) return kLeastPx * std::pow(kBinRatio, static_cast<double>(i) + 0.5);
  }
  return 0;
}

void PointSpacing::Pair::Add(const Eigen::Vector2d& apart) {
  u.Add(std::abs(apart.x()));
  v.Add(std::abs(apart.y()));
}

// Within the image; nothing for a miss.
std::optional<Eigen::Vector2d> PointSpacing::PixelOf(const Eigen::Vector3d& point_in_camera) const {
  if (!point_in_camera.allFinite()) return std::nullopt;
  const auto pixel = camera_.Project(point_in_camera);
  return pixel && camera_.Contains(*pixel) ? pixel : std::nullopt;
}

void PointSpacing::Add(const Cloud& cloud, const Rigid3& camera_from_lidar) {
  if (cloud.organised && cloud.beams > 1) {
    AddOrganised(cloud, camera_from_lidar.rotation);
  } else {
    AddUnorganised(cloud, camera_from_lidar);
  }
}

void PointSpacing::AddOrganised(const Cloud& cloud, const Eigen::Quaterniond& camera_from_lidar) {
  const auto far = [&](const Eigen::Vector3f& point) {
    return PixelOf(camera_from_lidar * point.cast<double>());
  };
  const auto beams = static_cast<std::size_t>(cloud.beams);
  const auto fired = [&](std::size_t i) {
    return cloud.directions.size() != cloud.size() || cloud.IsHit(i) ||
           cloud.directions[i].allFinite();
  };
  // What the next beam of a line met that was fired there: rings may take turns.
  const auto next = [&](std::size_t line, std::size_t beam, int step) {
    constexpr int kMostTurns = 4;
    for (int k = 1; k <= kMostTurns; ++k) {
      const std::int64_t at = static_cast<std::int64_t>(beam) + k * step;
      if (at < 0 || at >= cloud.beams) break;
      const std::size_t i = line * beams + static_cast<std::size_t>(at);
      if (fired(i)) return far(cloud.points[i]);
    }
    return std::optional<Eigen::Vector2d>();
  };
  // Some 40 lines of a cloud, every seventh beam.
  constexpr std::size_t kEvery = 7;
  const auto lines = static_cast<std::size_t>(cloud.lines);
  const std::size_t step = std::max<std::size_t>(1, lines / 40);
  const bool follows = line_before_.size() == beams && line_before_number_ + 1 == cloud.first_line;
  for (std::size_t line = 0; line < lines; line += step) {
    const Eigen::Vector3f* points = &cloud.points[line * beams];
    const Eigen::Vector3f* before = line > 0  ? points - beams
                                    : follows ? line_before_.data()
                                              : nullptr;
    for (std::size_t beam = 1; beam < beams; beam += kEvery) {
      const auto here = far(points[beam]);
      if (!here) continue;
      auto beside = next(line, beam, -1);
      if (!beside) beside = next(line, beam, 1);
      if (!beside) continue;
      Eigen::Vector2d along = *here - *beside;
      auto other = before != nullptr ? far(before[beam]) : std::nullopt;
      if (line > 0 && !fired((line - 1) * beams + beam)) other = next(line - 1, beam, -1);
      if (other) {
        Eigen::Vector2d across = *here - *other;
        Shorten(&along, &across);
        lines_.Add(across);
      }
      beams_.Add(along);
    }
  }
  line_before_.clear();
  if (lines == 1) line_before_ = cloud.points;
  line_before_number_ = cloud.first_line;
}

// From how densely points fill those parts of the image that they fill at all.
void PointSpacing::AddUnorganised(const Cloud& cloud, const Rigid3& camera_from_lidar) {
  constexpr int kParts = 32;
  constexpr std::size_t kSample = 20'000;
  std::vector<bool> filled(kParts * kParts);
  double count = 0;
  const std::size_t step = std::max<std::size_t>(1, cloud.size() / kSample);
  for (std::size_t i = 0; i < cloud.size(); i += step) {
    const auto pixel = PixelOf(camera_from_lidar * cloud.points[i].cast<double>());
    if (!pixel) continue;
    const auto column = static_cast<std::size_t>(pixel->x() * kParts / camera_.width());
    const auto row = static_cast<std::size_t>(pixel->y() * kParts / camera_.height());
    filled[row * kParts + column] = true;
    count += static_cast<double>(step);
  }
  if (count == 0) return;
  const auto parts = static_cast<double>(std::count(filled.begin(), filled.end(), true));
  const double area = parts * camera_.width() * camera_.height() / (kParts * kParts);
  constexpr double kUneven = 1.3;  // such points lie by chance, not in a grid
  unorganised_px_ = kUneven * std::sqrt(area / count);
}

Eigen::Vector2d PointSpacing::CellPx() const {
  Eigen::Vector2d cell(std::max(beams_.u.Median(), lines_.u.Median()),
                       std::max(beams_.v.Median(), lines_.v.Median()));
  // One line says nothing of the way across.
  if (lines_.u.empty()) cell.setConstant(cell.maxCoeff());
  if (beams_.u.empty() && lines_.u.empty()) cell.setConstant(unorganised_px_);
  const double least = std::max(2.0, camera_.width() / kMostCells);
  return (kCell * cell).cwiseMax(least).cwiseMin(camera_.width() / 8.0);
}

}  // namespace rgbdt
