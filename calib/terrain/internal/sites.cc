#include "calib/terrain/internal/sites.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "calib/terrain/internal/cells.h"

namespace rgbdt::terrain {
namespace {

constexpr double kHalfDiagonal = 0.70710678;  // of a cell, in cells

// From each cell's middle to the nearest point of a blocked cell [m], never too much. `outside`:
// whether what lies beyond the grid is blocked.
cv::Mat_<float> RoomAround(const TerrainGrid& grid, bool outside,
                           const std::function<bool(std::size_t)>& blocked) {
  cv::Mat_<unsigned char> free(grid.rows + 2, grid.columns + 2,
                               static_cast<unsigned char>(outside ? 0 : 1));
  bool any = outside;
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const bool is_blocked = blocked(grid.Index(column, row));
      free(row + 1, column + 1) = is_blocked ? 0 : 1;
      any |= is_blocked;
    }
  }
  cv::Mat_<float> room(free.size(), std::numeric_limits<float>::infinity());
  if (any) {
    cv::distanceTransform(free, room, cv::DIST_L2, cv::DIST_MASK_PRECISE);
    room = (room - kHalfDiagonal) * grid.cell_m;
  }
  return room(cv::Rect(1, 1, grid.columns, grid.rows)).clone();
}

/// Cells of a disc and the plane through their heights.
struct Disc {
  Eigen::Vector3d centre{0, 0, 0};
  double slope_rad = 0, roughness_m = 0, temperature_k = 0;
};

Disc FitDisc(const TerrainGrid& grid, std::size_t cell, double radius_m) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  double squares = 0, own = 0, temperature = 0;
  int cells = 0, warm = 0;
  const auto add = [&](std::size_t other, int dc, int dr) {
    const double x = dc * grid.cell_m, y = dr * grid.cell_m;
    if (std::hypot(x, y) > radius_m) return;
    const Eigen::Vector3d row(x, y, 1);
    const double height = grid.height_m[other];
    normal += row * row.transpose();
    right += row * height;
    squares += height * height;
    own += std::pow(grid.roughness_m[other], 2);
    ++cells;
    if (!std::isfinite(grid.temperature_k[other])) return;
    temperature += grid.temperature_k[other];
    ++warm;
  };
  add(cell, 0, 0);
  VisitAround(grid, cell, static_cast<int>(radius_m / grid.cell_m), add);
  const Eigen::Vector3d plane = normal.inverse() * right;
  Disc disc;
  disc.centre << grid.Centre(cell), plane.z();
  disc.slope_rad = std::atan(plane.head<2>().norm());
  const double off = std::max(0.0, squares - plane.dot(right));
  disc.roughness_m = std::sqrt((off + own) / cells);
  disc.temperature_k = warm > 0 ? temperature / warm : std::numeric_limits<double>::quiet_NaN();
  return disc;
}

double Flatness(double slope_rad, double roughness_m, const TerrainOptions& options) {
  const double slope = slope_rad / options.site_max_slope_rad;
  const double roughness = roughness_m / options.max_roughness_m;
  return 1 / (1 + slope * slope + roughness * roughness);
}

double Share(double value, double full) { return std::min(1.0, value / full); }

double Score(double slope_rad, double roughness_m, double radius_m, double clearance_m,
             const TerrainOptions& options) {
  return Flatness(slope_rad, roughness_m, options) * Share(radius_m, 3 * options.site_radius_m) *
         Share(clearance_m, 5 * options.site_radius_m);
}

/// A place for a site by its own cell's slope and roughness.
struct Candidate {
  double score;
  std::size_t cell;
};

}  // namespace

std::vector<LandingSite> FindSites(const TerrainGrid& grid, const TerrainOptions& options) {
  const cv::Mat_<float> room = RoomAround(grid, true, [&](std::size_t cell) {
    return grid.state[cell] != CellState::kTraversable || grid.interpolated[cell] ||
           grid.overhead[cell] || !std::isfinite(grid.roughness_m[cell]);
  });
  const cv::Mat_<float> clearance = RoomAround(grid, false, [&](std::size_t cell) {
    return grid.state[cell] == CellState::kObstacle || grid.overhead[cell];
  });
  // An obstacle's edge may reach into the next cell unseen: a cell's width is kept from obstacles.
  const auto radius_at = [&](std::size_t cell) {
    const auto i = static_cast<std::ptrdiff_t>(cell);
    return std::min(double{*(room.begin() + i)}, *(clearance.begin() + i) - grid.cell_m);
  };
  const auto clearance_at = [&](std::size_t cell) {
    return double{*(clearance.begin() + static_cast<std::ptrdiff_t>(cell))};
  };
  std::vector<Candidate> candidates;
  for (std::size_t cell = 0; cell < grid.size(); ++cell) {
    const double radius = radius_at(cell);
    if (!(radius >= options.site_radius_m) || grid.slope_rad[cell] > options.site_max_slope_rad) {
      continue;
    }
    candidates.push_back(
        {Score(grid.slope_rad[cell], grid.roughness_m[cell], radius, clearance_at(cell), options),
         cell});
  }
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return a.score != b.score ? a.score > b.score : a.cell < b.cell;
  });
  std::vector<LandingSite> sites;
  for (const Candidate& candidate : candidates) {
    if (sites.size() == static_cast<std::size_t>(options.max_sites)) break;
    const double radius = radius_at(candidate.cell);
    const Eigen::Vector2d centre = grid.Centre(candidate.cell);
    const bool overlaps = std::any_of(sites.begin(), sites.end(), [&](const LandingSite& site) {
      return (site.centre.head<2>() - centre).norm() < site.radius_m + radius;
    });
    if (overlaps) continue;
    const Disc disc = FitDisc(grid, candidate.cell, radius);
    if (disc.slope_rad > options.site_max_slope_rad) continue;
    const double clear = clearance_at(candidate.cell);
    sites.push_back({disc.centre, radius, disc.slope_rad, disc.roughness_m, clear,
                     disc.temperature_k,
                     Score(disc.slope_rad, disc.roughness_m, radius, clear, options)});
  }
  std::stable_sort(sites.begin(), sites.end(),
                   [](const LandingSite& a, const LandingSite& b) { return a.score > b.score; });
  return sites;
}

}  // namespace rgbdt::terrain
