#include "calib/detect/image/internal/measured_corners.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "calib/model/linear_algebra.h"
#include "calib/model/statistics.h"
#include "calib/model/view_detection.h"

namespace rgbdt {
namespace {

constexpr double kLeastSpread = 0.7;   // RMS across the corners' longest direction, in squares
constexpr double kMostResidual = 0.5;  // median of CornerFit::residual, as for FindCheckerboard
constexpr double kUsualBlurPx = 1;     // before it is known

template <typename Value>
double MedianOf(const MeasuredCorners& measured, const Value& value) {
  std::vector<double> values;
  for (const auto& fit : measured.fits) {
    if (fit) values.push_back(value(*fit));
  }
  return Median(std::move(values));
}

// The grid at a corner, and what FitCorner may look at there.
struct Surroundings {
  GridPlace grid;
  double clear = std::numeric_limits<double>::infinity();  ///< as FitCorner's
};

// A marker's blur reaches some sigma beyond it; but half of what is free always counts.
double FreeOf(double free_px, double blur_px) {
  return std::max(0.5 * free_px, free_px - 1.5 * blur_px);
}

// Of a marker that stands alone: over its border inwards, outwards as far as the board and the
// white between marker and hole reach.
std::optional<Surroundings> SurroundingsOfLone(const Target& target, const BoardMap& map,
                                               const Eigen::Vector2d& corner, double blur_px) {
  constexpr double kOfMarker = 0.3;  // a sheet that it is printed on ends soon
  const Markers& markers = *target.markers;
  const Eigen::Vector2d gaps = target.holes->marker_spacing_m.array() - markers.side_m;
  double free_m = std::min({0.5 * target.width_m - std::abs(corner.x()),
                            0.5 * target.height_m - std::abs(corner.y()), gaps.minCoeff()});
  for (const Eigen::Vector2d& hole : target.HoleCentres()) {
    free_m = std::min(free_m, ((corner - hole).norm() - target.holes->radius_m) * M_SQRT1_2);
  }
  const double marker_m = kOfMarker * markers.side_m;
  const auto whole = GridAt(map, corner, std::min(marker_m, free_m) / kCornerReach);
  if (!whole) return std::nullopt;
  const double px_per_m = kCornerReach * whole->spacing() / std::min(marker_m, free_m);
  const double step_m =
      std::min(marker_m, FreeOf(free_m * px_per_m, blur_px) / px_per_m) / kCornerReach;
  const auto grid = GridAt(map, corner, step_m);
  if (!grid) return std::nullopt;
  const int cells = FindMarkerFamily(markers.family)->cells + 2 * markers.border_bits;
  const double border_px = px_per_m * markers.side_m * markers.border_bits / cells;
  return Surroundings{*grid, FreeOf(border_px, blur_px) / grid->spacing()};
}

// Of ChArUco along the edges, as far as markers leave it free; of a grid of markers as far as gap
// and border reach.
std::optional<Surroundings> SurroundingsOf(const Target& target, const BoardMap& map,
                                           const Eigen::Vector2d& corner, double blur_px) {
  if (target.holes) return SurroundingsOfLone(target, map, corner, blur_px);
  const bool of_grid = target.markers && target.markers->grid();
  double step_m = target.square_m;
  if (of_grid) {
    const Markers& markers = *target.markers;
    const int cells = FindMarkerFamily(markers.family)->cells + 2 * markers.border_bits;
    step_m = std::min(markers.gap_m, markers.side_m * markers.border_bits / cells) / kCornerReach;
  }
  auto grid = GridAt(map, corner, step_m);
  if (!grid || !target.markers) return grid ? std::optional<Surroundings>({*grid}) : std::nullopt;
  const double spacing = grid->spacing();
  if (!of_grid) {
    const double free_px = 0.5 * (1 - target.markers->side_m / target.square_m) * spacing;
    return Surroundings{*grid, FreeOf(free_px, blur_px) / spacing};
  }
  const double share = FreeOf(kCornerReach * spacing, blur_px) / (kCornerReach * spacing);
  grid = GridAt(map, corner, share * step_m);
  return grid ? std::optional<Surroundings>({*grid}) : std::nullopt;
}

}  // namespace

double MeasuredCorners::contrast() const {
  return MedianOf(*this, [](const CornerFit& f) { return f.contrast; });
}
double MeasuredCorners::blur_px() const {
  return MedianOf(*this, [](const CornerFit& f) { return f.blur_px; });
}
double MeasuredCorners::sigma_px() const {
  return MedianOf(*this, [](const CornerFit& f) { return f.sigma_px; });
}
double MeasuredCorners::residual() const {
  return MedianOf(*this, [](const CornerFit& f) { return f.residual; });
}
double MeasuredCorners::noise() const {
  return MedianOf(*this, [](const CornerFit& f) { return f.residual * std::abs(f.contrast); });
}

std::size_t MeasuredCorners::count() const {
  const auto good = std::count_if(fits.begin(), fits.end(), [](const auto& f) { return f; });
  return static_cast<std::size_t>(good);
}

std::vector<Eigen::Vector2d> MeasuredCorners::places() const {
  std::vector<Eigen::Vector2d> places;
  for (const auto& fit : fits) places.push_back(fit ? fit->place : UnseenCorner());
  return places;
}

MeasuredCorners MeasureCorners(const cv::Mat& grey, double saturated_from, const Target& target,
                               const BoardMap& map, std::optional<double> blur_px,
                               const std::vector<bool>& wanted) {
  const auto corners = target.InnerCorners();
  MeasuredCorners measured;
  measured.fits.resize(corners.size());
  measured.spacings.resize(corners.size());
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (!wanted.empty() && !wanted[i]) continue;
    const auto around =
        SurroundingsOf(target, map, corners[i].head<2>(), blur_px.value_or(kUsualBlurPx));
    if (!around) continue;
    const GridPlace& grid = around->grid;
    measured.spacings[i] = grid.spacing();
    auto& fit = measured.fits[i];
    const int column = static_cast<int>(i) % target.corners_x();
    const int row = static_cast<int>(i) / target.corners_x();
    // Markers that stand alone begin at even columns and rows, and end at odd ones.
    const LonePatch lone =
        target.holes ? LonePatch(column % 2 == 0 ? 1 : -1, row % 2 == 0 ? 1 : -1) : LonePatch(0, 0);
    fit = FitCorner(grey, grid.place, grid.steps, grid.bends, blur_px, saturated_from,
                    around->clear, lone);
    const bool even = (column + row) % 2 == 0;
    if (fit && !even && !target.holes) fit->contrast = -fit->contrast;
  }
  return measured;
}

void DropUnlike(MeasuredCorners* measured) {
  const double contrast = measured->contrast();
  const double noise = measured->noise();
  const double sigma = measured->sigma_px();
  for (auto& fit : measured->fits) {
    if (!fit) continue;
    const double relative = fit->contrast / contrast;
    const bool similar = relative > 0.25 && relative < 4;
    const double residual = fit->residual * std::abs(fit->contrast);
    const bool clean = residual < 1.3 * noise + 0.01 * std::abs(contrast);
    if (!similar || !clean || fit->sigma_px > 3 * sigma + 0.02) fit.reset();
  }
}

bool Enough(const Target& target, const std::vector<Eigen::Vector2d>& corners) {
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  const auto points = target.InnerCorners();
  const auto seen = std::count_if(corners.begin(), corners.end(), IsSeen);
  if (seen < kLeastCorners) return false;
  const auto count = static_cast<double>(seen);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (IsSeen(corners[i])) middle += points[i].head<2>() / count;
  }
  Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector2d off = points[i].head<2>() - middle;
    if (IsSeen(corners[i])) scatter += off * off.transpose() / count;
  }
  const double spread = std::sqrt(std::max(0.0, EigensystemOf(scatter).values[0]));
  return spread > kLeastSpread * target.square_m;
}

bool Enough(const Target& target, const MeasuredCorners& measured) {
  return measured.residual() < kMostResidual && Enough(target, measured.places());
}

}  // namespace rgbdt
