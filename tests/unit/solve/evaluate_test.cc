#include "calib/solve/evaluate.h"

#include <cmath>

#include "tests/unit/matchers.h"

namespace rgbdt {
namespace {

// A camera that looks along z with f = 100 px: a point (x, y, 1) projects to (100 x, 100 y) + c.
CameraSpec PlainCamera() {
  CameraSpec spec;
  spec.name = "rgb";
  spec.width = 200;
  spec.height = 100;
  spec.lens = {Lens::Model::kPinhole, 100, 100, 100, 50, {}};
  return spec;
}

Eigen::Vector3d PointAt(double u, double v) { return {(u - 100) / 100, (v - 50) / 100, 1}; }

// One edge pixel, and a square outline of 40 px whose left side runs through it.
ViewDetection Detection(const std::vector<Eigen::Vector3d>& boundary, bool heldout = false) {
  ImageEdges image;
  image.width = 200;
  image.height = 100;
  image.edge_pixels = {{80, 50}};
  image.outline = {{80, 30}, {120, 30}, {120, 70}, {80, 70}};
  ViewDetection detection;
  detection.view = heldout ? "held" : "used";
  detection.heldout = heldout;
  detection.images = {{"rgb", 0, image, "", 0}};
  detection.cloud.candidates.resize(1);
  detection.cloud.candidates[0].boundary = boundary;
  return detection;
}

ViewQuality Judge(const std::vector<Eigen::Vector3d>& boundary,
                  const Rigid3& camera_from_lidar = {}) {
  const ViewDetection detection = Detection(boundary);
  return JudgeView(PlainCamera(), CameraViewOf("rgb", detection), camera_from_lidar);
}

TEST(JudgeView, IsTheMeanTransformAndTheRmsToTheOutline) {
  // (83.2, 54.4) falls on pixel (83, 54): 3 and 4 from the edge pixel, 5 px; 3.2 px from the left
  // side. (80, 45): 5 px from the edge pixel, on the outline. (75, 50): 5 px from both.
  const ViewQuality quality = Judge({PointAt(83.2, 54.4), PointAt(80, 45), PointAt(75, 50)});
  EXPECT_EQ(quality.view, "used");
  EXPECT_FALSE(quality.heldout);
  EXPECT_NEAR(quality.distance_transform_px, 5, 1e-6);
  EXPECT_NEAR(quality.edge_rms_px, std::sqrt((3.2 * 3.2 + 0 + 25) / 3), 1e-9);
}

TEST(JudgeView, TheOutlineIsClosedAndEndsAtItsCorners) {
  const auto rms = [](double u, double v) { return Judge({PointAt(u, v)}).edge_rms_px; };
  EXPECT_NEAR(rms(78, 60), 2, 1e-9);   // from the closing side
  EXPECT_NEAR(rms(77, 26), 5, 1e-9);   // from the corner (80, 30)
  EXPECT_NEAR(rms(123, 74), 5, 1e-9);  // from the corner (120, 70)
  EXPECT_NEAR(rms(100, 45), 15, 1e-9);
}

TEST(JudgeView, UsesTheCalibration) {
  // point_in_camera = point_in_lidar + (0.05, 0, 0): 5 px to the right at 1 m.
  Rigid3 camera_from_lidar;
  camera_from_lidar.translation = {0.05, 0, 0};
  const ViewQuality quality = Judge({PointAt(80, 50)}, camera_from_lidar);
  EXPECT_NEAR(quality.distance_transform_px, 5, 1e-6);
}

TEST(JudgeView, APointThatNoLensCanSeeCountsHalfTheWidth) {
  const ViewQuality quality = Judge({PointAt(80, 50), {0, 0, -1}});
  EXPECT_NEAR(quality.distance_transform_px, 50, 1e-6);  // 0 and 100
  EXPECT_NEAR(quality.edge_rms_px, std::sqrt(0.5 * 100 * 100), 1e-9);
}

TEST(JudgeCamera, MeansAreOverPointsAndKeepHeldOutViewsApart) {
  // Used: transforms 0 and 5, 5, 5 in two views of 1 and 3 points. Held out: 10.
  const std::vector<ViewDetection> detections = {
      Detection({PointAt(80, 50)}), Detection({PointAt(75, 50), PointAt(80, 55), PointAt(80, 45)}),
      Detection({PointAt(70, 50)}, true)};
  const CameraView one = CameraViewOf("rgb", detections[0]);
  const CameraView three = CameraViewOf("rgb", detections[1]);
  const CameraView held = CameraViewOf("rgb", detections[2]);
  CameraReport report;
  report.views.resize(9);  // an earlier judgement is replaced
  report = JudgeCamera(PlainCamera(), {&one, &three, &held}, report);
  ASSERT_EQ(report.views.size(), 3U);
  EXPECT_TRUE(report.views[2].heldout);
  EXPECT_NEAR(report.distance_transform_px.train.value(), 15.0 / 4, 1e-6);
  EXPECT_NEAR(report.edge_rms_px.train.value(), std::sqrt(25.0 / 4), 1e-9);
  EXPECT_NEAR(report.distance_transform_px.heldout.value(), 10, 1e-6);
  EXPECT_NEAR(report.edge_rms_px.heldout.value(), 10, 1e-9);
}

TEST(JudgeCamera, WhatIsNotToBeHadIsAbsent) {
  const ViewDetection detection = Detection({PointAt(80, 50)});
  const CameraView one = CameraViewOf("rgb", detection);
  const CameraReport report = JudgeCamera(PlainCamera(), {&one}, {});
  EXPECT_TRUE(report.distance_transform_px.train);
  EXPECT_FALSE(report.distance_transform_px.heldout);
  EXPECT_FALSE(report.edge_rms_px.heldout);
}

}  // namespace
}  // namespace rgbdt
