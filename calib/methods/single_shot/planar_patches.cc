#include "calib/methods/single_shot/planar_patches.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "calib/detect/cloud/board_crossings.h"
#include "calib/detect/cloud/plane_regions.h"
#include "calib/detect/cloud/range_grid.h"
#include "calib/model/check.h"

namespace rgbdt {
namespace {

std::vector<cv::Point2f> Flattened(const PlaneRegion& region, const PlaneFrame& frame) {
  std::vector<cv::Point2f> flat;
  flat.reserve(region.points.size());
  for (const Eigen::Vector3f& point : region.points) {
    const Eigen::Vector2d p = frame.Flat(point.cast<double>());
    flat.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()));
  }
  return flat;
}

CloudEdges PatchOf(const PlaneRegion& region) {
  PlaneSums sums;
  for (const Eigen::Vector3f& point : region.points) sums.Add(point.cast<double>());
  const Plane plane = sums.Fit();
  const PlaneFrame frame(plane, sums.Mean());
  const std::vector<cv::Point2f> flat = Flattened(region, frame);
  const cv::RotatedRect box = cv::minAreaRect(flat);
  CloudEdges patch;
  // Not the points' mean: they lie closer together where the piece is nearer.
  patch.centre = frame.Solid({box.center.x, box.center.y});
  patch.normal = plane.normal;
  patch.points = sums.count();
  patch.scatter_sigma_m = sums.Rms(plane);
  for (const Eigen::Vector3f& point : region.points) {
    Eigen::Vector4d q(0, 0, 0, 1);
    q.head<3>() = point.cast<double>() - patch.centre;
    patch.scatter += q * q.transpose();
  }
  patch.raw_scatter = patch.scatter;
  patch.width_m = std::max(box.size.width, box.size.height);
  patch.height_m = std::min(box.size.width, box.size.height);
  patch.spacing_m = std::sqrt(patch.width_m * patch.height_m / patch.points);
  std::vector<cv::Point2f> hull;
  cv::convexHull(flat, hull);
  for (const cv::Point2f& corner : hull) {
    patch.boundary.push_back(frame.Solid({corner.x, corner.y}));
  }
  return patch;
}

// By how much of itself a size differs from the board's.
double Unlike(const CloudEdges& patch, const Target& target) {
  const double longer = std::max(target.width_m, target.height_m);
  const double shorter = std::min(target.width_m, target.height_m);
  return std::abs(std::log((patch.width_m + patch.spacing_m) / longer)) +
         std::abs(std::log((patch.height_m + patch.spacing_m) / shorter));
}

bool IsAsLarge(const CloudEdges& patch, const Target& target, const PatchOptions& options) {
  const double longer = std::max(target.width_m, target.height_m);
  const double shorter = std::min(target.width_m, target.height_m);
  const double width = patch.width_m + patch.spacing_m;
  const double height = patch.height_m + patch.spacing_m;
  return width > options.least_size * longer && width < options.most_size * longer &&
         height > options.least_size * shorter && height < options.most_size * shorter;
}

}  // namespace

void PatchOptions::Check() const {
  const OptionCheck check("planar patches");
  check.Positive(range_sigma_m, "range_sigma_m");
  check.Between(least_size, 0, 1, "least_size");
  check.AtLeast(static_cast<int>(most_patches), 1, "most_patches");
}

std::vector<CloudEdges> PlanarPatches(const Cloud& cloud, const Target& target,
                                      const PatchOptions& options) {
  options.Check();
  const RangeGrid grid(cloud);
  PlaneRegionOptions regions;
  regions.sigma_m = std::max(0.008, options.range_sigma_m);
  regions.largest_m = 2.2 * std::hypot(target.width_m, target.height_m);
  regions.smallest_m = std::min(target.width_m, target.height_m);
  regions.seed_m = std::min(0.15, 0.2 * regions.smallest_m);
  constexpr std::size_t kLeastPoints = 12;
  std::vector<CloudEdges> patches;
  for (const PlaneRegion& region : FindPlaneRegions(grid, regions)) {
    if (region.points.size() < kLeastPoints) continue;
    CloudEdges patch = PatchOf(region);
    if (IsAsLarge(patch, target, options)) patches.push_back(std::move(patch));
  }
  std::stable_sort(patches.begin(), patches.end(), [&](const CloudEdges& a, const CloudEdges& b) {
    return Unlike(a, target) < Unlike(b, target);
  });
  if (patches.size() > options.most_patches) patches.resize(options.most_patches);
  return patches;
}

}  // namespace rgbdt
