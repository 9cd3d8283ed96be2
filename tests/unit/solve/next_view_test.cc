#include "calib/solve/internal/next_view.h"

#include "calib/methods/calibrate.h"
#include "tests/unit/solve/solve_world.h"

namespace rgbdt {
namespace {

using testing::HasSubstr;

class NextViewOf : public testing::TestWithParam<std::uint32_t> {};
INSTANTIATE_TEST_SUITE_P(Seeds, NextViewOf, testing::Values(1U, 2U, 3U));

TEST_P(NextViewOf, HoldingTheBoardThereShrinksTheSigmaAsPromised) {
  SolveWorldOptions options;
  options.views = 5;
  options.seed = GetParam();
  SolveWorld world(options);
  const Report report = Calibrate(world.rig, world.detections);
  ASSERT_TRUE(report.next_view);
  const NextView& next = *report.next_view;
  EXPECT_TRUE(world.Seen(next.lidar_from_target));
  EXPECT_THAT(next.words, HasSubstr("hold the board"));
  EXPECT_LT(next.sigma_after_px, 0.95 * next.sigma_before_px);
  world.AddView(next.lidar_from_target);
  const Report then = Calibrate(world.rig, world.detections);
  ASSERT_TRUE(then.next_view);
  EXPECT_NEAR(then.next_view->sigma_before_px, next.sigma_after_px, 0.25 * next.sigma_after_px);
}

TEST(FindNextView, WhatItSaysBeforeIsTheWorstSigmaOfTheReport) {
  const SolveWorld world;
  const Report report = Calibrate(world.rig, world.detections);
  ASSERT_TRUE(report.next_view);
  double worst = 0;
  std::string camera;
  for (const CameraReport& c : report.cameras) {
    ASSERT_EQ(c.calibration.status, SolveStatus::kConverged);
    for (const ColouringSigma& at : c.sigma->colouring) {
      if (at.distance_m != 5 || at.worst_px <= worst) continue;
      worst = at.worst_px;
      camera = c.calibration.camera;
    }
  }
  EXPECT_EQ(report.next_view->camera, camera);
  EXPECT_NEAR(report.next_view->sigma_before_px, worst, 0.05 * worst);
}

// calib/detect/TARGET.md: six rings, which cross the outline twice each.
TEST(FindNextView, ProposesNoPlaceWithTooFewRings) {
  SolveWorldOptions options;
  options.views = 6;
  SolveWorld world(options);
  double farthest = 0;
  for (std::size_t i = 0; i < world.detections.size(); ++i) {
    auto& crossings = world.CloudAt(i).crossings;
    std::vector<Crossing> few;  // so many that 12 are left at 3.2 m
    const double range = world.CloudAt(i).centre.norm();
    const auto wanted = static_cast<std::size_t>(12 * 3.2 / range);
    for (std::size_t k = 0; k < wanted; ++k)
      few.push_back(crossings[k * crossings.size() / wanted]);
    crossings = few;
    farthest = std::max(farthest, range);
  }
  ASSERT_GT(farthest, 3.5);
  const Report report = Calibrate(world.rig, world.detections);
  ASSERT_TRUE(report.next_view);
  EXPECT_LE(report.next_view->lidar_from_target.translation.norm(), 3.5);
}

TEST(FindNextView, OfCamerasThatSeeNothingInCommonThereIsNone) {
  const SolveWorld world;
  const SolveSession session(world);
  JointResult result = SolveJointly(session.Joint());
  ASSERT_TRUE(FindNextView(result));
  Rigid3& second = result.solution.state.camera_from_lidar[1];
  second = RotationAbout({0, 1, 0}, M_PI) * second;
  EXPECT_FALSE(FindNextView(result));
}

}  // namespace
}  // namespace rgbdt
