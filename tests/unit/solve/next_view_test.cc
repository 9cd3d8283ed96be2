#include "calib/solve/internal/next_view.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

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

double ElevationOf(const Eigen::Vector3d& point) {
  return std::atan2(point.z(), point.head<2>().norm());
}

// How many rings, 6 degrees apart, lie on the board there.
constexpr double kRingSpacing = 6 * M_PI / 180;
double RingsOn(const Target& target, const Rigid3& lidar_from_target) {
  std::vector<double> elevations;
  for (const Eigen::Vector3d& corner : target.OutlineCorners()) {
    elevations.push_back(ElevationOf(lidar_from_target * corner));
  }
  const auto [low, high] = std::minmax_element(elevations.begin(), elevations.end());
  return (*high - *low) / kRingSpacing;
}

// calib/detect/TARGET.md: six rings.
TEST(FindNextView, ProposesNoPlaceWithTooFewRings) {
  SolveWorldOptions options;
  options.views = 6;
  SolveWorld world(options);
  const Report dense = Calibrate(world.rig, world.detections);
  ASSERT_TRUE(dense.next_view);
  EXPECT_LT(RingsOn(world.rig.target, dense.next_view->lidar_from_target), 5.5);
  for (std::size_t i = 0; i < world.detections.size(); ++i) {
    auto& crossings = world.CloudAt(i).crossings;
    std::set<std::pair<long, int>> taken;  // one for each ring and side
    std::vector<Crossing> few;
    for (const Crossing& crossing : crossings) {
      const double elevation = ElevationOf(crossing.point);
      const long ring = std::lround(elevation / kRingSpacing);
      const bool on_ring = std::abs(elevation - ring * kRingSpacing) < 0.1 * kRingSpacing;
      if (on_ring && taken.insert({ring, crossing.side}).second) few.push_back(crossing);
    }
    crossings = few;
  }
  const Report report = Calibrate(world.rig, world.detections);
  ASSERT_TRUE(report.next_view);
  EXPECT_GT(RingsOn(world.rig.target, report.next_view->lidar_from_target), 5.5);
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
