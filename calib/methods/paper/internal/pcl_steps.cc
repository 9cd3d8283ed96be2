#include "calib/methods/paper/internal/pcl_steps.h"

#include <pcl/console/print.h>
#include <pcl/features/boundary.h>
#include <pcl/kdtree/kdtree_flann.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>
#include <pcl/surface/concave_hull.h>
#include <pcl/surface/mls.h>

namespace rgbdt {
namespace {

using PclCloud = pcl::PointCloud<pcl::PointXYZ>;

PclCloud::Ptr ToPcl(const std::vector<Eigen::Vector3f>& points) {
  auto cloud = std::make_shared<PclCloud>();
  cloud->reserve(points.size());
  for (const Eigen::Vector3f& p : points) cloud->emplace_back(p.x(), p.y(), p.z());
  return cloud;
}

}  // namespace

struct PointIndex::Impl {
  pcl::KdTreeFLANN<pcl::PointXYZ> tree;
};

PointIndex::PointIndex(const std::vector<Eigen::Vector3f>& points)
    : impl_(std::make_unique<Impl>()) {
  impl_->tree.setInputCloud(ToPcl(points));
}

PointIndex::~PointIndex() = default;

void PointIndex::Within(const Eigen::Vector3f& c, double radius, std::vector<int>* indices) const {
  std::vector<float> squared;
  impl_->tree.radiusSearch(pcl::PointXYZ(c.x(), c.y(), c.z()), radius, *indices, squared);
}

void PointIndex::Nearest(const Eigen::Vector3f& c, int count, std::vector<int>* indices) const {
  std::vector<float> squared;
  impl_->tree.nearestKSearch(pcl::PointXYZ(c.x(), c.y(), c.z()), count, *indices, squared);
}

std::vector<Eigen::Vector3f> BoundaryByPcl(const std::vector<Eigen::Vector3f>& segment,
                                           const BoundaryOptions& options) {
  pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
  if (segment.size() < 4) return {};

  pcl::MovingLeastSquares<pcl::PointXYZ, pcl::PointNormal> mls;
  mls.setInputCloud(ToPcl(segment));
  mls.setSearchMethod(std::make_shared<pcl::search::KdTree<pcl::PointXYZ>>());
  mls.setSearchRadius(options.mls_radius);
  mls.setPolynomialOrder(1);  // the board is flat
  mls.setComputeNormals(true);
  auto smooth = std::make_shared<pcl::PointCloud<pcl::PointNormal>>();
  mls.process(*smooth);
  if (smooth->size() < 4) return {};

  pcl::BoundaryEstimation<pcl::PointNormal, pcl::PointNormal, pcl::Boundary> estimation;
  estimation.setInputCloud(smooth);
  estimation.setInputNormals(smooth);
  estimation.setSearchMethod(std::make_shared<pcl::search::KdTree<pcl::PointNormal>>());
  estimation.setRadiusSearch(options.boundary_radius);
  estimation.setAngleThreshold(static_cast<float>(options.boundary_angle_rad));
  pcl::PointCloud<pcl::Boundary> flags;
  estimation.compute(flags);

  auto boundary = std::make_shared<PclCloud>();
  for (std::size_t i = 0; i < flags.size(); ++i) {
    const pcl::PointNormal& p = (*smooth)[i];
    if (flags[i].boundary_point != 0) boundary->emplace_back(p.x, p.y, p.z);
  }
  if (boundary->size() < 4) return {};

  pcl::ConcaveHull<pcl::PointXYZ> hull;
  hull.setInputCloud(boundary);
  hull.setDimension(2);
  hull.setAlpha(options.hull_alpha);
  hull.setKeepInformation(true);  // the points themselves, not their projections
  PclCloud vertices;
  hull.reconstruct(vertices);

  std::vector<Eigen::Vector3f> out;
  out.reserve(vertices.size());
  for (const pcl::PointXYZ& p : vertices) out.emplace_back(p.x, p.y, p.z);
  return out;
}

}  // namespace rgbdt
