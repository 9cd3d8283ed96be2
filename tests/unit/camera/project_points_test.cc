#include "calib/camera/project_points.h"

#include <gtest/gtest.h>

#include <random>

namespace rgbdt {
namespace {

CameraSpec SpecOf(Lens::Model model) {
  CameraSpec spec;
  spec.width = 1936;
  spec.height = 1456;
  spec.lens.model = model;
  spec.lens.fx = model == Lens::Model::kFisheye ? 520 : 1100;
  spec.lens.fy = spec.lens.fx + 7;
  spec.lens.cx = 960;
  spec.lens.cy = 731;
  if (model == Lens::Model::kFisheye) {
    spec.lens.distortion = {0.02, -0.004, 0.001, -0.0003, 0, 0, 0, 0};
  } else {
    spec.lens.distortion = {-0.21, 0.09, 0.001, -0.0006, -0.02, 0.01, 0.003, 0.0005};
  }
  return spec;
}

std::vector<Eigen::Vector3f> PointsAllRound(std::size_t count) {
  std::mt19937 engine(7);
  std::normal_distribution<float> normal;
  std::vector<Eigen::Vector3f> points;
  for (std::size_t i = 0; i < count; ++i) {
    points.emplace_back(6 * normal(engine), 6 * normal(engine), 6 * normal(engine));
  }
  return points;
}

class ProjectPoints : public testing::TestWithParam<Lens::Model> {};

TEST_P(ProjectPoints, IsCameraProject) {
  const Camera camera(SpecOf(GetParam()));
  Rigid3 camera_from_points = RotationAbout(Eigen::Vector3d(1, -2, 3).normalized(), 1.1);
  camera_from_points.translation = {0.1, -0.2, 0.3};
  const auto points = PointsAllRound(5000);
  PixelColumns pixels;
  pixels.Resize(points.size());
  const PointProjector projector(camera, camera_from_points);
  // In two pieces, neither a whole number of blocks.
  projector.Project(points[0].data(), 0, 1700, &pixels);
  projector.Project(points[0].data(), 1700, points.size() - 1700, &pixels);
  int seen = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d p = camera_from_points * points[i].cast<double>();
    const auto pixel = camera.Project(p);
    if (!pixel || !camera.Contains(*pixel)) continue;
    ++seen;
    EXPECT_NEAR(pixels.u[i], pixel->x(), 0.002) << i;
    EXPECT_NEAR(pixels.v[i], pixel->y(), 0.002) << i;
    EXPECT_NEAR(pixels.inverse_range[i] * p.norm(), 1, 1e-5) << i;
  }
  EXPECT_GT(seen, 400);
}

TEST_P(ProjectPoints, WhatTheLensDoesNotSeeIsZero) {
  const Camera camera(SpecOf(GetParam()));
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  auto points = PointsAllRound(3000);
  points[5] = {kNan, 1, 1};
  points[6] = {0, 0, kInfinity};
  points[7] = {0, 0, 0};
  PixelColumns pixels;
  pixels.Resize(points.size());
  PointProjector(camera, Rigid3()).Project(points[0].data(), 0, points.size(), &pixels);
  int unseen = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d p = points[i].cast<double>();
    const double angle = std::acos(p.z() / p.norm());
    if (std::abs(angle - camera.max_angle()) < 1e-3) continue;  // single precision may differ
    const bool sees = points[i].allFinite() && camera.Project(p).has_value();
    unseen += sees ? 0 : 1;
    EXPECT_EQ(pixels.inverse_range[i] > 0, sees) << i;
    if (!sees) {
      EXPECT_EQ(pixels.u[i], 0);
      EXPECT_EQ(pixels.v[i], 0);
    }
  }
  EXPECT_GE(unseen, 3);
}

// Each point is seen in the row that is exposed when the camera is where it sees it there.
TEST_P(ProjectPoints, AMovingCameraIsReadOutRowByRow) {
  const Camera camera(SpecOf(GetParam()));
  Vector6d delta_per_row;  // over the whole image: 1 degree, 5 cm
  delta_per_row << 0.012, -0.017, 0.008, 0.05, -0.02, 0.03;
  delta_per_row /= 1455;
  std::vector<Eigen::Vector3f> points;
  for (float x = -2; x <= 2; x += 0.5F) {
    for (float y = -1.5F; y <= 1.5F; y += 0.5F) points.emplace_back(x, y, 4.F);
  }
  PixelColumns pixels;
  pixels.Resize(points.size());
  PointProjector projector(camera, Rigid3());
  projector.SetMotion(delta_per_row);
  projector.Project(points[0].data(), 0, points.size(), &pixels);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Rigid3 moved = Exp((pixels.v[i] - 727.5) * delta_per_row);
    const auto pixel = camera.Project(moved * points[i].cast<double>());
    ASSERT_TRUE(pixel);
    // To first order: over the image 10 to 20 px, of which 0.3 px may be left.
    EXPECT_NEAR(pixels.u[i], pixel->x(), 0.3);
    EXPECT_NEAR(pixels.v[i], pixel->y(), 0.3);
  }
}

INSTANTIATE_TEST_SUITE_P(Lenses, ProjectPoints,
                         testing::Values(Lens::Model::kPinhole, Lens::Model::kFisheye));

}  // namespace
}  // namespace rgbdt
