#include "calib/camera/target_pose.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "calib/detect/image/internal/corner_order.h"
#include "tests/numbers.h"
#include "tests/unit/matchers.h"

namespace rgbdt {
namespace {

Target Board() {
  Target target;
  target.squares_x = 11;
  target.squares_y = 8;
  target.square_m = 0.1;
  target.width_m = 1.2192;
  target.height_m = 0.9144;
  target.pattern_offset_m = {0.004, -0.003};
  return target;
}

CameraSpec Pinhole() {
  CameraSpec spec;
  spec.width = 1936;
  spec.height = 1456;
  spec.lens.fx = 1100;
  spec.lens.fy = 1102;
  spec.lens.cx = 960;
  spec.lens.cy = 730;
  spec.lens.distortion = {-0.12, 0.08, 0.001, -0.0008, -0.01};
  return spec;
}

CameraSpec RationalPinhole() {
  CameraSpec spec = Pinhole();
  spec.lens.distortion = {0.3, 0.05, 0.001, -0.0008, 0.003, 0.42, 0.09, 0.01};
  return spec;
}

CameraSpec Fisheye() {
  CameraSpec spec = Pinhole();
  spec.lens.model = Lens::Model::kFisheye;
  spec.lens.fx = spec.lens.fy = 600;
  spec.lens.distortion = {0.02, -0.01, 0.003, -0.001};
  return spec;
}

double Normal(Random* random) {
  return std::sqrt(-2 * std::log(random->Uniform(1e-12, 1))) *
         std::cos(2 * 180 * kDegree * random->Uniform(0, 1));
}

// The board 2 to 6 m away, tilted by up to 50 degrees, up to `off_axis` [rad] beside the middle.
Rigid3 DrawPose(double off_axis, Random* random) {
  const double turn = random->Uniform(0, 360 * kDegree);
  Rigid3 pose = RotationAbout({std::cos(turn), std::sin(turn), 0},
                              random->Uniform(2 * kDegree, 50 * kDegree)) *
                RotationAbout({0, 0, 1}, random->Uniform(-180 * kDegree, 180 * kDegree));
  const double towards = random->Uniform(0, 360 * kDegree);
  const Rigid3 aside =
      RotationAbout({std::cos(towards), std::sin(towards), 0}, random->Uniform(0, off_axis));
  pose.translation = {0, 0, random->Uniform(2, 6)};
  return aside * pose;
}

// Nothing where a corner lies outside the image.
std::vector<Eigen::Vector2d> Corners(const Camera& camera, const Rigid3& pose, double sigma_px,
                                     Random* random) {
  std::vector<Eigen::Vector2d> corners;
  for (const Eigen::Vector3d& point : Board().InnerCorners()) {
    const auto pixel = camera.Project(pose * point);
    if (!pixel || !camera.Contains(*pixel)) return {};
    corners.emplace_back(*pixel + sigma_px * Eigen::Vector2d(Normal(random), Normal(random)));
  }
  return corners;
}

struct Trials {
  double mean_chi2 = 0, mean_sigma = 0, above_95 = 0;
  int count = 0;
};

Trials RunTrials(const CameraSpec& spec, double off_axis, std::uint32_t seed) {
  constexpr double kSigma = 0.08;
  constexpr int kTrials = 1000;
  const Camera camera(spec);
  Random random(seed);
  Trials trials;
  while (trials.count < kTrials) {
    const Rigid3 truth = DrawPose(off_axis, &random);
    const auto corners = Corners(camera, truth, kSigma, &random);
    if (corners.empty()) continue;
    const auto found = PoseFromCorners(camera, Board(), corners);
    if (!found) {
      ADD_FAILURE() << "no pose in trial " << trials.count;
      return trials;
    }
    const Vector6d delta = Log(truth * found->pose.sensor_from_target.Inverse());
    const double chi2 = delta.dot(found->pose.covariance.ldlt().solve(delta));
    ++trials.count;
    trials.mean_chi2 += chi2 / kTrials;
    trials.mean_sigma += found->corner_sigma_px / kSigma / kTrials;
    trials.above_95 += chi2 > 12.59 ? 1.0 / kTrials : 0.0;  // 95% of chi-square with 6 degrees
  }
  return trials;
}

class PoseError : public ::testing::TestWithParam<const char*> {};

TEST_P(PoseError, IsAsLargeAsTheCovarianceSays) {
  const std::string lens = GetParam();
  const Trials trials = lens == "fisheye"    ? RunTrials(Fisheye(), 70 * kDegree, 1)
                        : lens == "rational" ? RunTrials(RationalPinhole(), 25 * kDegree, 2)
                                             : RunTrials(Pinhole(), 25 * kDegree, 3);
  RecordProperty("mean_chi2", std::to_string(trials.mean_chi2));
  RecordProperty("above_95", std::to_string(trials.above_95));
  RecordProperty("sigma_ratio", std::to_string(trials.mean_sigma));
  // With sigma estimated from 134 degrees of freedom the mean is 6 * 134 / 132 = 6.09, a little
  // more as good corners beyond 4 sigma are left out (3000 trials: 6.08 to 6.20, 5.5 to 6.4%
  // above). Of 1000 trials its own sigma is sqrt(12 / 1000) = 0.11, and 4 of those are allowed.
  EXPECT_NEAR(trials.mean_chi2, 6.15, 0.44);
  EXPECT_NEAR(trials.above_95, 0.06, 0.03);  // 4 sigma of a count of 60
  EXPECT_NEAR(trials.mean_sigma, 1, 0.01);   // 1 / sqrt(2 * 134 * 1000) = 0.002
}

INSTANTIATE_TEST_SUITE_P(Lenses, PoseError, ::testing::Values("pinhole", "rational", "fisheye"));

TEST(TargetPose, WrongCornersDoNotMoveThePose) {
  const Camera camera(Pinhole());
  Random random(7);
  Rigid3 truth = RotationAbout({1, 0.4, 0}, 25 * kDegree);
  truth.translation = {0.1, -0.2, 4};
  for (const double off : {3.0, 7.0}) {
    for (const std::size_t wrong : {0U, 9U, 35U, 69U}) {
      auto corners = Corners(camera, truth, 0.05, &random);
      ASSERT_FALSE(corners.empty());
      corners[wrong] += off * Eigen::Vector2d(0.6, 0.8);
      corners[40] -= Eigen::Vector2d(off, 0);
      const auto found = PoseFromCorners(camera, Board(), corners);
      ASSERT_TRUE(found.has_value());
      EXPECT_FALSE(found->used[wrong]);
      EXPECT_FALSE(found->used[40]);
      // 0.03 degrees is what clean corners of this noise give at this distance (3 sigma).
      EXPECT_THAT(found->pose.sensor_from_target, Rigid3Near(truth, 0.06 * kDegree, 0.004));
      EXPECT_NEAR(found->corner_sigma_px, 0.05, 0.015);  // 4 sigma of 0.05 / sqrt(2 * 130)
    }
  }
}

TEST(TargetPose, PerfectCornersGiveThePoseAndTheFloorOfSigma) {
  const Camera camera(Fisheye());
  Random random(1);
  Rigid3 ahead = RotationAbout({0.4, 1, 0}, 20 * kDegree);
  ahead.translation = {0, 0, 4};
  const Rigid3 truth = RotationAbout({0.3, 1, 0}, 65 * kDegree) * ahead;  // 65 degrees aside
  const auto corners = Corners(camera, truth, 0, &random);
  ASSERT_FALSE(corners.empty());
  const auto found = PoseFromCorners(camera, Board(), corners);
  ASSERT_TRUE(found.has_value());
  EXPECT_THAT(found->pose.sensor_from_target, Rigid3Near(truth, 1e-6, 1e-6));
  EXPECT_EQ(found->corner_sigma_px, 0.01);
}

TEST(TargetPose, WhatNoFlatBoardMakesHasNoPose) {
  const Camera camera(Pinhole());
  Random random(3);
  Rigid3 truth = RotationAbout({1, 0, 0}, 0.3);
  truth.translation = {0, 0, 3};
  const auto good = Corners(camera, truth, 0.05, &random);
  ASSERT_TRUE(PoseFromCorners(camera, Board(), good).has_value());

  auto few = good;
  few.pop_back();
  EXPECT_FALSE(PoseFromCorners(camera, Board(), few).has_value());

  auto mirrored = good;
  for (auto row = mirrored.begin(); row != mirrored.end(); row += 10) std::reverse(row, row + 10);
  EXPECT_FALSE(PoseFromCorners(camera, Board(), mirrored).has_value());

  auto line = good;
  for (std::size_t i = 0; i < line.size(); ++i) line[i] = {100.0 + static_cast<double>(i), 200};
  EXPECT_FALSE(PoseFromCorners(camera, Board(), line).has_value());

  auto scattered = good;
  for (std::size_t i = 0; i < scattered.size(); i += 3) scattered[i].x() += 15;
  EXPECT_FALSE(PoseFromCorners(camera, Board(), scattered).has_value());
}

TEST(WhyNoFlatBoard, SaysWhatOfTheLensCannotBeRight) {
  CameraSpec spec = Pinhole();
  EXPECT_THAT(WhyNoFlatBoard(Camera(spec)), testing::Not(testing::HasSubstr("exchanged")));
  std::swap(spec.lens.fy, spec.lens.cy);
  const std::string why = WhyNoFlatBoard(Camera(spec));
  EXPECT_THAT(why, testing::HasSubstr("were fy and cy exchanged?"));
  EXPECT_THAT(why, testing::Not(testing::HasSubstr("fx")));
}

}  // namespace
}  // namespace rgbdt
