#pragma once

#include <memory>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "calib/simulate/internal/board.h"
#include "calib/simulate/internal/rig_defaults.h"
#include "calib/simulate/internal/world.h"
#include "calib/simulate/simulator.h"

namespace rgbdt::simulate {

/// The default cameras at a quarter of the resolution: what does not depend on it runs fast.
inline Options SmallOptions(Scene scene = Scene::kOutdoor) {
  Options options;
  options.scene = scene;
  for (CameraOptions& camera : options.cameras) {
    camera.width /= 4;
    camera.height /= 4;
    camera.lens.fx /= 4;
    camera.lens.fy /= 4;
    camera.lens.cx = (camera.lens.cx + 0.5) / 4 - 0.5;
    camera.lens.cy = (camera.lens.cy + 0.5) / 4 - 0.5;
  }
  return options;
}

/// A world of grey sheets and nothing else.
inline World SheetWorld(const std::vector<Mesh>& sheets, double reflectivity,
                        const Options& options) {
  auto scene = std::make_shared<SceneModel>();
  for (const Mesh& mesh : sheets) {
    SceneObject object{"sheet", mesh, {}};
    object.material.reflectivity = reflectivity;
    scene->objects.push_back(object);
  }
  return {scene, std::nullopt, options};
}

/// Pixels of points in camera coordinates, by OpenCV: the simulator's own lens is held to it.
inline std::vector<cv::Point2d> OpenCvPixels(const Lens& lens,
                                             const std::vector<cv::Point3d>& points_in_camera) {
  const cv::Matx33d k(lens.fx, 0, lens.cx, 0, lens.fy, lens.cy, 0, 0, 1);
  const cv::Mat distortion(1, 8, CV_64F, const_cast<double*>(lens.distortion.data()));
  std::vector<cv::Point2d> pixels;
  cv::projectPoints(points_in_camera, cv::Vec3d(0, 0, 0), cv::Vec3d(0, 0, 0), k, distortion,
                    pixels);
  return pixels;
}

inline std::vector<cv::Point2d> OpenCvPixels(const Lens& lens, const Rigid3& camera_from_target,
                                             const std::vector<Eigen::Vector3d>& places) {
  std::vector<cv::Point3d> points;
  for (const Eigen::Vector3d& place : places) {
    const Eigen::Vector3d p = camera_from_target * place;
    points.emplace_back(p.x(), p.y(), p.z());
  }
  return OpenCvPixels(lens, points);
}

}  // namespace rgbdt::simulate
