// Finding the board: in rendered images beside OpenCV's detector, in clouds beside what a user
// builds from PCL's parts.
#include <pcl/common/common.h>
#include <pcl/filters/extract_indices.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/sample_consensus/method_types.h>
#include <pcl/sample_consensus/model_types.h>
#include <pcl/search/kdtree.h>
#include <pcl/segmentation/extract_clusters.h>
#include <pcl/segmentation/sac_segmentation.h>
#include <pcl/surface/concave_hull.h>

#include <cmath>
#include <map>
#include <memory>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>

#include "calib/camera/pixels.h"
#include "calib/detect/cloud/board_in_cloud.h"
#include "calib/detect/image/checkerboard.h"
#include "calib/simulate/internal/board.h"
#include "tests/bench/analytic_cloud.h"
#include "tests/bench/measure.h"
#include "tests/bench/stages.h"
#include "tests/study/image_scenes.h"

namespace rgbdt::bench {
namespace {

using PclCloud = pcl::PointCloud<pcl::PointXYZ>;

constexpr std::uint64_t kSeed = 1;
// PCL's clustering takes minutes beyond.
constexpr std::int64_t kMostForPcl = 100'000;

const study::ImageScene& SceneOf(const std::string& class_name) {
  static std::map<std::string, study::ImageScene> scenes;  // rendering takes seconds
  const auto known = scenes.find(class_name);
  if (known != scenes.end()) return known->second;
  for (const study::SceneClass& scene_class : study::SceneClasses()) {
    if (scene_class.name != class_name) continue;
    study::RenderScenes(scene_class, 1, kSeed, [&](int, const study::ImageScene& scene) {
      scenes.emplace(class_name, scene);
    });
  }
  return scenes.at(class_name);
}

std::function<void()> InImage(const std::string& class_name) {
  const study::ImageScene& scene = SceneOf(class_name);
  return [&scene] {
    const CheckerboardResult result =
        FindCheckerboard(ToGrey(scene.image), scene.target, SaturatedFrom(scene.image));
    if (!result.board) throw std::runtime_error("no board in the image: " + result.why);
  };
}

cv::Mat EightBitsOf(const Image& image) {
  cv::Mat grey;
  if (image.format == PixelFormat::kMono16) {
    cv::normalize(image.pixels, grey, 0, 255, cv::NORM_MINMAX, CV_8U);
  } else {
    cv::cvtColor(image.pixels, grey, cv::COLOR_BayerBG2GRAY);
  }
  return grey;
}

// Whether it finds the board or not: that is its own affair.
std::function<void()> InImageByOpenCv(const std::string& class_name) {
  const study::ImageScene& scene = SceneOf(class_name);
  return [&scene] {
    const cv::Size inner(scene.target.corners_x(), scene.target.corners_y());
    std::vector<cv::Point2f> corners;
    bool found = cv::findChessboardCornersSB(EightBitsOf(scene.image), inner, corners, 0);
    benchmark::DoNotOptimize(found);
  };
}

struct CloudScene {
  Target target;
  Cloud cloud;
};

CloudScene MakeCloudScene(std::int64_t points) {
  CloudScene scene;
  scene.target = simulate::MakeTarget({});
  scene.cloud = AnalyticCloud(scene.target, DrawBoard(kSeed, 0), static_cast<int>(points), kSeed);
  return scene;
}

std::function<void()> InCloud(std::int64_t points) {
  const auto scene = std::make_shared<CloudScene>(MakeCloudScene(points));
  return [scene] {
    const BoardsInCloud boards = FindBoards(scene->cloud, scene->target);
    if (boards.candidates.empty()) throw std::runtime_error("no board: " + boards.why);
  };
}

// Takes the plane with the most points out of `rest`.
PclCloud::Ptr TakePlane(PclCloud::Ptr* rest) {
  pcl::SACSegmentation<pcl::PointXYZ> segmentation;
  segmentation.setModelType(pcl::SACMODEL_PLANE);
  segmentation.setMethodType(pcl::SAC_RANSAC);
  segmentation.setDistanceThreshold(0.03);
  segmentation.setMaxIterations(200);
  segmentation.setInputCloud(*rest);
  const pcl::PointIndices::Ptr inliers(new pcl::PointIndices);
  pcl::ModelCoefficients plane;
  segmentation.segment(*inliers, plane);
  pcl::ExtractIndices<pcl::PointXYZ> extract;
  extract.setInputCloud(*rest);
  extract.setIndices(inliers);
  PclCloud::Ptr on_plane(new PclCloud);
  const PclCloud::Ptr others(new PclCloud);
  extract.filter(*on_plane);
  extract.setNegative(true);
  extract.filter(*others);
  *rest = others;
  return on_plane;
}

std::vector<pcl::PointIndices> Clusters(const PclCloud::Ptr& cloud) {
  const pcl::search::KdTree<pcl::PointXYZ>::Ptr tree(new pcl::search::KdTree<pcl::PointXYZ>);
  tree->setInputCloud(cloud);
  pcl::EuclideanClusterExtraction<pcl::PointXYZ> extraction;
  extraction.setClusterTolerance(0.1);
  extraction.setMinClusterSize(50);
  extraction.setSearchMethod(tree);
  extraction.setInputCloud(cloud);
  std::vector<pcl::PointIndices> clusters;
  extraction.extract(clusters);
  return clusters;
}

// The hull of a cluster as large as the board.
bool IsBoard(const PclCloud::Ptr& plane, const pcl::PointIndices& indices, const Target& target) {
  const PclCloud::Ptr cluster(new PclCloud(*plane, indices.indices));
  pcl::PointXYZ low, high;
  pcl::getMinMax3D(*cluster, low, high);
  const double extent = std::hypot(high.x - low.x, std::hypot(high.y - low.y, high.z - low.z));
  const double diagonal = std::hypot(target.width_m, target.height_m);
  if (extent < 0.7 * diagonal || extent > 1.4 * diagonal) return false;
  pcl::ConcaveHull<pcl::PointXYZ> hull;
  hull.setDimension(2);
  hull.setAlpha(0.2);
  hull.setInputCloud(cluster);
  PclCloud outline;
  hull.reconstruct(outline);
  return !outline.empty();
}

std::function<void()> InCloudByPcl(std::int64_t points) {
  const auto scene = std::make_shared<CloudScene>(MakeCloudScene(points));
  return [scene] {
    PclCloud::Ptr rest(new PclCloud);
    for (const Eigen::Vector3f& p : scene->cloud.points) rest->push_back({p.x(), p.y(), p.z()});
    const std::size_t few = rest->size() / 100;
    bool found = false;
    while (!found && rest->size() > few) {
      const PclCloud::Ptr plane = TakePlane(&rest);
      if (plane->empty()) break;
      for (const pcl::PointIndices& cluster : Clusters(plane)) {
        found = found || IsBoard(plane, cluster, scene->target);
      }
    }
    if (!found) throw std::runtime_error("PCL found no board");
  };
}

}  // namespace

void RegisterDetect(std::int64_t most) {
  const auto image = [](const char* row, const char* class_name, std::int64_t pixels) {
    Register({row, "rgbdt", pixels, "pixels"}, [=] { return InImage(class_name); });
    Register({row, "cv::findChessboardCornersSB", pixels, "pixels"},
             [=] { return InImageByOpenCv(class_name); });
  };
  image("detect_image_rgb", "color_outdoor", 1936 * 1456);
  image("detect_image_thermal", "thermal_outdoor", 640 * 480);
  for (const std::int64_t size : Decades(most)) {
    Register({"detect_cloud", "rgbdt", size, "points"}, [=] { return InCloud(size); });
    if (size > kMostForPcl) continue;
    Register({"detect_cloud", "PCL: planes, clusters, hulls", size, "points"},
             [=] { return InCloudByPcl(size); });
  }
}

}  // namespace rgbdt::bench
