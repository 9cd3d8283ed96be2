#include "calib/fuse/point_spacing.h"

#include <algorithm>
#include <cmath>

namespace rgbdt {
namespace {

constexpr double kLeastPx = 0.05;   // of the histogram's first bin
constexpr double kBinRatio = 1.17;  // of the next one: 64 bins end at 1000 px
constexpr double kCell = 1.1;       // of the spacing
constexpr double kMostCells = 480;  // along the image's width: finer ones cost more than they tell

}  // namespace

void PointSpacing::Histogram::Add(float distance_px) {
  const double bin =
      std::log(std::max(kLeastPx, double(distance_px)) / kLeastPx) / std::log(kBinRatio);
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

void PointSpacing::Pair::Add(const PixelColumns& pixels, std::size_t i, float other_u,
                             float other_v) {
  u.Add(std::abs(pixels.u[i] - other_u));
  v.Add(std::abs(pixels.v[i] - other_v));
}

PointSpacing::PointSpacing(const Camera& camera)
    : width_(camera.width()), height_(camera.height()) {}

bool PointSpacing::InImage(const PixelColumns& pixels, std::size_t i) const {
  return pixels.inverse_range[i] > 0 && pixels.u[i] >= 0 && pixels.v[i] >= 0 &&
         pixels.u[i] < static_cast<float>(width_) && pixels.v[i] < static_cast<float>(height_);
}

void PointSpacing::Add(const Cloud& cloud, const std::vector<std::uint32_t>& grid,
                       const PixelColumns& pixels) {
  if (cloud.organised && cloud.beams > 1) {
    AddOrganised(cloud, grid, pixels);
  } else {
    AddUnorganised(pixels);
  }
}

void PointSpacing::AddOrganised(const Cloud& cloud, const std::vector<std::uint32_t>& grid,
                                const PixelColumns& pixels) {
  // A sample is enough: of many lines every eighth and the one after it.
  constexpr std::size_t kEvery = 7;  // beams
  constexpr int kFewLines = 16;
  const auto beams = static_cast<std::size_t>(cloud.beams);
  std::vector<Pixel> line(beams);
  std::size_t i = 0;
  for (std::size_t number = 0; number < static_cast<std::size_t>(cloud.lines); ++number) {
    if (cloud.lines > kFewLines && number % 8 > 1) continue;
    i = static_cast<std::size_t>(std::lower_bound(grid.begin() + static_cast<std::ptrdiff_t>(i),
                                                  grid.end(), number * beams) -
                                 grid.begin());
    std::fill(line.begin(), line.end(), Pixel{});
    for (; i < grid.size() && grid[i] / beams == number; ++i) {
      const std::size_t beam = grid[i] % beams;
      line[beam] = {pixels.u[i], pixels.v[i], InImage(pixels, i)};
      if (beam % kEvery != 0 || !line[beam].seen) continue;
      if (beam > 0 && line[beam - 1].seen)
        beams_.Add(pixels, i, line[beam - 1].u, line[beam - 1].v);
      const bool follows = line_before_.size() == beams &&
                           line_before_number_ + 1 == cloud.first_line + static_cast<int>(number);
      if (follows && line_before_[beam].seen) {
        lines_.Add(pixels, i, line_before_[beam].u, line_before_[beam].v);
      }
    }
    line_before_.swap(line);
    line.resize(beams);
    line_before_number_ = cloud.first_line + static_cast<int>(number);
  }
}

// From how densely points fill those parts of the image that they fill at all.
void PointSpacing::AddUnorganised(const PixelColumns& pixels) {
  constexpr int kParts = 32;
  std::vector<bool> filled(kParts * kParts);
  double count = 0;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (!InImage(pixels, i)) continue;
    const auto column = static_cast<std::size_t>(pixels.u[i] * kParts / static_cast<float>(width_));
    const auto row = static_cast<std::size_t>(pixels.v[i] * kParts / static_cast<float>(height_));
    filled[row * kParts + column] = true;
    ++count;
  }
  if (count == 0) return;
  const auto parts = static_cast<double>(std::count(filled.begin(), filled.end(), true));
  const double area = parts * width_ * height_ / (kParts * kParts);
  constexpr double kUneven = 1.3;  // such points lie by chance, not in a grid
  unorganised_px_ = kUneven * std::sqrt(area / count);
}

Eigen::Vector2d PointSpacing::CellPx() const {
  Eigen::Vector2d cell(std::max(beams_.u.Median(), lines_.u.Median()),
                       std::max(beams_.v.Median(), lines_.v.Median()));
  // One line says nothing of the way across.
  if (lines_.u.empty()) cell.setConstant(cell.maxCoeff());
  if (beams_.u.empty() && lines_.u.empty()) cell.setConstant(unorganised_px_);
  const double least = std::max(2.0, width_ / kMostCells);
  return (kCell * cell).cwiseMax(least).cwiseMin(width_ / 8.0);
}

}  // namespace rgbdt
