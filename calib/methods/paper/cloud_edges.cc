#include "calib/methods/paper/cloud_edges.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <random>
#include <sstream>

#include "calib/methods/paper/internal/pcl_steps.h"
#include "calib/model/check.h"
#include "calib/model/linear_algebra.h"
#include "calib/model/statistics.h"

namespace rgbdt {
namespace {

using Points = std::vector<Eigen::Vector3f>;
using Indices = std::vector<int>;

// The beams that returned something, and which scan line each belongs to.
struct Hits {
  Points points;
  std::vector<int> line;  // empty: not known
};

struct Plane {
  Eigen::Vector3d normal{0, 0, 0};
  double offset = 0;  // normal . p = offset
  double Distance(const Eigen::Vector3f& p) const {
    return std::abs(normal.dot(p.cast<double>()) - offset);
  }
};

Hits HitsOf(const Cloud& cloud) {
  Hits hits;
  const bool lined = cloud.organised && cloud.lines > 1;
  const bool ringed = !lined && cloud.ring.size() == cloud.size();
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!cloud.points[i].allFinite()) continue;
    hits.points.push_back(cloud.points[i]);
    if (lined) hits.line.push_back(static_cast<int>(i) / cloud.beams);
    if (ringed) hits.line.push_back(cloud.ring[i]);
  }
  return hits;
}

// Step b, first half: points that the guess puts near a checkerboard corner.
Indices PointsNearCorners(const Points& points, const Camera& camera,
                          const Rigid3& camera_from_lidar,
                          const std::vector<Eigen::Vector2d>& corners, double half_window) {
  // A mask of the windows: each point then costs one look.
  cv::Mat mask = cv::Mat::zeros(camera.height(), camera.width(), CV_8U);
  for (const Eigen::Vector2d& c : corners) {
    if (!IsSeen(c)) continue;
    cv::rectangle(mask,
                  cv::Point(static_cast<int>(std::lround(c.x() - half_window)),
                            static_cast<int>(std::lround(c.y() - half_window))),
                  cv::Point(static_cast<int>(std::lround(c.x() + half_window)),
                            static_cast<int>(std::lround(c.y() + half_window))),
                  255, cv::FILLED);
  }
  Indices near;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto pixel = camera.Project(camera_from_lidar * points[i].cast<double>());
    if (!pixel || !camera.Contains(*pixel)) continue;
    if (mask.at<std::uint8_t>(static_cast<int>(std::lround(pixel->y())),
                              static_cast<int>(std::lround(pixel->x()))) != 0) {
      near.push_back(static_cast<int>(i));
    }
  }
  return near;
}

// Median distance to the nearest point on another scan line; without lines, of an even grid with
// the same eighth neighbour.
double SpacingAt(const Hits& hits, const PointIndex& index, const Indices& at) {
  constexpr std::size_t kSamples = 300;
  constexpr int kNeighbours = 120;
  std::vector<double> distances;
  Indices near;
  const std::size_t step = std::max<std::size_t>(1, at.size() / kSamples);
  for (std::size_t k = 0; k < at.size(); k += step) {
    const auto i = static_cast<std::size_t>(at[k]);
    index.Nearest(hits.points[i], hits.line.empty() ? 9 : kNeighbours, &near);
    for (std::size_t n = 0; n < near.size(); ++n) {
      const auto j = static_cast<std::size_t>(near[n]);
      const double distance = (hits.points[j] - hits.points[i]).norm();
      if (hits.line.empty() ? n == 8 : hits.line[j] != hits.line[i]) {
        distances.push_back(hits.line.empty() ? distance / std::sqrt(2.0) : distance);
        break;
      }
    }
  }
  return distances.size() < 10 ? 0 : Median(std::move(distances));
}

Plane FitPlane(const Points& points, const Indices& indices) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const int i : indices) mean += points[static_cast<std::size_t>(i)].cast<double>();
  mean /= static_cast<double>(indices.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const int i : indices) {
    const Eigen::Vector3d d = points[static_cast<std::size_t>(i)].cast<double>() - mean;
    scatter += d * d.transpose();
  }
  Plane plane;
  plane.normal = EigensystemOf(scatter).vectors.col(0);
  plane.offset = plane.normal.dot(mean);
  return plane;
}

Indices InliersOf(const Plane& plane, const Points& points, const Indices& of, double tolerance) {
  Indices inliers;
  for (const int i : of) {
    if (plane.Distance(points[static_cast<std::size_t>(i)]) <= tolerance) inliers.push_back(i);
  }
  return inliers;
}

// Step b, second half: the plane most of those points lie on. Seeded: the same every time.
Indices PlaneInliers(const Points& points, const Indices& of, double tolerance) {
  std::mt19937 random(1);
  Indices best;
  for (int trial = 0; trial < 200; ++trial) {
    Eigen::Vector3d p[3];
    for (Eigen::Vector3d& q : p) {
      q = points[static_cast<std::size_t>(of[random() % of.size()])].cast<double>();
    }
    const Eigen::Vector3d normal = (p[1] - p[0]).cross(p[2] - p[0]);
    if (normal.norm() < 1e-6) continue;
    Plane plane;
    plane.normal = normal.normalized();
    plane.offset = plane.normal.dot(p[0]);
    Indices inliers = InliersOf(plane, points, of, tolerance);
    if (inliers.size() > best.size()) best = std::move(inliers);
  }
  if (best.size() < 3) return best;
  return InliersOf(FitPlane(points, best), points, of, tolerance);
}

int SeedOf(const Points& points, const PointIndex& index, const Indices& inliers) {
  Eigen::Vector3f centroid = Eigen::Vector3f::Zero();
  for (const int i : inliers) centroid += points[static_cast<std::size_t>(i)];
  centroid /= static_cast<float>(inliers.size());
  Indices nearest;
  index.Nearest(centroid, 1, &nearest);
  return nearest[0];
}

// Step a: neighbours whose normals agree with the seed's, and their neighbours, until no more.
// Normals are computed where the region comes, not over the whole cloud.
class RegionGrower {
 public:
  RegionGrower(const Points& points, const PointIndex& index, double grow_radius,
               double normal_radius, double angle)
      : points_(points),
        index_(index),
        grow_radius_(grow_radius),
        normal_radius_(normal_radius),
        min_cosine_(std::cos(angle)) {}

  Indices Grow(int seed) {
    const Eigen::Vector3d normal = NormalAt(seed);
    std::vector<char> seen(points_.size(), 0);
    Indices region = {seed};
    seen[static_cast<std::size_t>(seed)] = 1;
    Indices near;
    for (std::size_t next = 0; next < region.size(); ++next) {
      index_.Within(points_[static_cast<std::size_t>(region[next])], grow_radius_, &near);
      for (const int j : near) {
        if (seen[static_cast<std::size_t>(j)] != 0) continue;
        seen[static_cast<std::size_t>(j)] = 1;
        if (std::abs(NormalAt(j).dot(normal)) >= min_cosine_) region.push_back(j);
      }
    }
    return region;
  }

 private:
  Eigen::Vector3d NormalAt(int i) {
    index_.Within(points_[static_cast<std::size_t>(i)], normal_radius_, &neighbours_);
    if (neighbours_.size() < 3) return Eigen::Vector3d::Zero();
    return FitPlane(points_, neighbours_).normal;
  }

  const Points& points_;
  const PointIndex& index_;
  double grow_radius_, normal_radius_, min_cosine_;
  Indices neighbours_;
};

// Fills centre, normal and extent from the boundary and the segment.
void Measure(const Points& points, const Indices& segment, CloudEdges* edges) {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const int i : segment) centre += points[static_cast<std::size_t>(i)].cast<double>();
  edges->centre = centre / static_cast<double>(segment.size());
  const Plane plane = FitPlane(points, segment);
  edges->normal =
      plane.normal.dot(edges->centre) > 0 ? Eigen::Vector3d(-plane.normal) : plane.normal;
  const Eigen::Vector3d u = edges->normal.unitOrthogonal();
  const Eigen::Vector3d v = edges->normal.cross(u);
  std::vector<cv::Point2f> flat;
  for (const Eigen::Vector3d& p : edges->boundary) {
    const Eigen::Vector3d d = p - edges->centre;
    flat.emplace_back(static_cast<float>(d.dot(u)), static_cast<float>(d.dot(v)));
  }
  const cv::RotatedRect box = cv::minAreaRect(flat);
  edges->width_m = std::max(box.size.width, box.size.height);
  edges->height_m = std::min(box.size.width, box.size.height);
  edges->points = static_cast<int>(segment.size());
}

std::string WhyNotTheTarget(const CloudEdges& edges, const Target& target, double tolerance) {
  const double width = std::max(target.width_m, target.height_m);
  const double height = std::min(target.width_m, target.height_m);
  const double slack = 2 * edges.spacing_m;
  if (std::abs(edges.width_m - width) <= tolerance * width + slack &&
      std::abs(edges.height_m - height) <= tolerance * height + slack) {
    return "";
  }
  std::ostringstream text;
  text.precision(2);
  text << std::fixed << "the segment found in the cloud measures " << edges.width_m << " x "
       << edges.height_m << " m, the rig file's target " << width << " x " << height
       << " m; is something touching the board, or the guess too far off?";
  return text.str();
}

}  // namespace

void CloudEdgesOptions::Check() const {
  const OptionCheck check("cloud edges");
  check.Positive(corner_window_px, "corner_window_px");
  check.Positive(ransac_tolerance, "ransac_tolerance");
  check.Positive(grow_radius, "grow_radius");
  check.Positive(normal_radius, "normal_radius");
  check.Positive(grow_angle_rad, "grow_angle_rad");
  check.Positive(mls_radius, "mls_radius");
  check.Positive(boundary_radius, "boundary_radius");
  check.Positive(boundary_angle_rad, "boundary_angle_rad");
  check.Positive(hull_alpha, "hull_alpha");
  check.Positive(size_tolerance, "size_tolerance");
}

CloudEdgesResult DetectCloudEdges(const Cloud& cloud, const Camera& camera,
                                  const Rigid3& camera_from_lidar_guess,
                                  const std::vector<Eigen::Vector2d>& image_corners,
                                  const Target& target, const CloudEdgesOptions& options) {
  options.Check();
  const Hits hits = HitsOf(cloud);
  if (hits.points.size() < 100) {
    return {std::nullopt, "the cloud has " + std::to_string(hits.points.size()) +
                              " points; is the LIDAR connected and the view not covered?"};
  }
  const Indices near = PointsNearCorners(hits.points, camera, camera_from_lidar_guess,
                                         image_corners, 0.5 * options.corner_window_px);
  if (near.size() < 20) {
    return {std::nullopt, "the guess brings only " + std::to_string(near.size()) +
                              " cloud points near the checkerboard's corners; measure "
                              "camera_from_lidar_guess in the rig file better"};
  }
  const PointIndex index(hits.points);
  CloudEdges edges;
  edges.spacing_m = SpacingAt(hits, index, near);
  if (!(edges.spacing_m > 0)) {
    return {std::nullopt, "the cloud is too sparse where the board should be"};
  }
  const double s = edges.spacing_m;
  const Indices inliers = PlaneInliers(hits.points, near, options.ransac_tolerance * s);
  if (inliers.size() < 10) {
    return {std::nullopt, "no plane in the cloud where the board should be"};
  }
  RegionGrower grower(hits.points, index, options.grow_radius * s, options.normal_radius * s,
                      options.grow_angle_rad);
  const Indices segment = grower.Grow(SeedOf(hits.points, index, inliers));
  Points segment_points;
  for (const int i : segment) segment_points.push_back(hits.points[static_cast<std::size_t>(i)]);
  const auto boundary =
      BoundaryByPcl(segment_points, {options.mls_radius * s, options.boundary_radius * s,
                                     options.boundary_angle_rad, options.hull_alpha * s});
  if (boundary.size() < 8) {
    return {std::nullopt, "the segment found in the cloud (" + std::to_string(segment.size()) +
                              " points) has no clear boundary"};
  }
  for (const Eigen::Vector3f& p : boundary) edges.boundary.emplace_back(p.cast<double>());
  Measure(hits.points, segment, &edges);
  const std::string why = WhyNotTheTarget(edges, target, options.size_tolerance);
  if (!why.empty()) return {std::nullopt, why};
  return {edges, ""};
}

}  // namespace rgbdt
