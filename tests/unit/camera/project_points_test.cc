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

// Of all points; what ForBlocks leaves out is 0.
struct Columns {
  std::vector<float> u, v, inverse_range;
  std::size_t blocks = 0;

  Columns(const PointProjector& projector, const Camera& camera,
          const std::vector<Eigen::Vector3f>& points)
      : u(points.size()), v(points.size()), inverse_range(points.size()) {
    projector.ForBlocks(ViewBounds(camera), BlockedPoints(points), 0, points.size(),
                        [&](std::size_t first, std::size_t count, const PixelBlock& block) {
                          ++blocks;
                          for (std::size_t i = 0; i < count; ++i) {
                            u[first + i] = block.u[i];
                            v[first + i] = block.v[i];
                            inverse_range[first + i] = block.inverse_range[i];
                          }
                        });
  }
};

class ProjectPoints : public testing::TestWithParam<Lens::Model> {};

TEST(ProjectPoints5, ALensOfFiveCoefficientsIsCameraProject) {
  CameraSpec spec = SpecOf(Lens::Model::kPinhole);
  std::fill(spec.lens.distortion.begin() + 5, spec.lens.distortion.end(), 0);
  const Camera camera(spec);
  const auto points = PointsAllRound(2000);
  const Columns pixels(PointProjector(camera, Rigid3()), camera, points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto pixel = camera.Project(points[i].cast<double>());
    if (!pixel || !camera.Contains(*pixel)) continue;
    EXPECT_NEAR(pixels.u[i], pixel->x(), 0.002) << i;
    EXPECT_NEAR(pixels.v[i], pixel->y(), 0.002) << i;
  }
}

TEST_P(ProjectPoints, IsCameraProject) {
  const Camera camera(SpecOf(GetParam()));
  Rigid3 camera_from_points = RotationAbout(Eigen::Vector3d(1, -2, 3).normalized(), 1.1);
  camera_from_points.translation = {0.1, -0.2, 0.3};
  const auto points = PointsAllRound(5000);
  const Columns pixels(PointProjector(camera, camera_from_points), camera, points);
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
  const Columns pixels(PointProjector(camera, Rigid3()), camera, points);
  int unseen = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d p = points[i].cast<double>();
    const double angle = std::acos(p.z() / p.norm());
    if (std::abs(angle - camera.max_angle()) < 1e-3) continue;  // single precision may differ
    const auto pixel = camera.Project(p);
    const bool sees = points[i].allFinite() && pixel.has_value();
    // What lies far from the image may be left out.
    if (sees && !camera.Contains(*pixel)) continue;
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
  PointProjector projector(camera, Rigid3());
  projector.SetMotion(delta_per_row);
  const Columns pixels(projector, camera, points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Rigid3 moved = Exp((pixels.v[i] - 727.5) * delta_per_row);
    const auto pixel = camera.Project(moved * points[i].cast<double>());
    ASSERT_TRUE(pixel);
    // To first order: over the image 10 to 20 px, of which 0.3 px may be left.
    EXPECT_NEAR(pixels.u[i], pixel->x(), 0.3);
    EXPECT_NEAR(pixels.v[i], pixel->y(), 0.3);
  }
}

// Columns of a scanner all round: those that the camera cannot see are not looked at.
TEST(ViewBounds, LeavesOutWhatLiesElsewhereAndNothingElse) {
  CameraSpec spec = SpecOf(Lens::Model::kPinhole);
  for (double& k : spec.lens.distortion) k *= 0.3;  // as it is, its corners see nothing
  const Camera camera(spec);
  Rigid3 camera_from_lidar;
  camera_from_lidar.rotation =
      Eigen::Quaterniond((Eigen::Matrix3d() << 0, -1, 0, 0, 0, -1, 1, 0, 0).finished());
  camera_from_lidar.translation = {0.3, 0.1, 0.05};
  std::vector<Eigen::Vector3f> points;
  for (int line = 0; line < 360; ++line) {
    for (int beam = 0; beam < 512; ++beam) {
      const double azimuth = line * M_PI / 180;
      const double elevation = 0.002 * (beam - 256);
      points.emplace_back(6 * std::cos(azimuth), 6 * std::sin(azimuth), 6 * std::tan(elevation));
    }
  }
  const Columns pixels(PointProjector(camera, camera_from_lidar), camera, points);
  EXPECT_LT(pixels.blocks, 140U);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto pixel = camera.Project(camera_from_lidar * points[i].cast<double>());
    if (pixel && camera.Contains(*pixel)) {
      ASSERT_GT(pixels.inverse_range[i], 0);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Lenses, ProjectPoints,
                         testing::Values(Lens::Model::kPinhole, Lens::Model::kFisheye));

}  // namespace
}  // namespace rgbdt
