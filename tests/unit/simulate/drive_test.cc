#include "calib/simulate/internal/drive.h"

#include <gtest/gtest.h>

#include <cmath>

#include "calib/simulate/internal/room.h"
#include "calib/simulate/internal/street.h"

namespace rgbdt::simulate {
namespace {

Options OnItsWay(std::uint64_t seed, Scene scene) {
  Options options;
  options.seed = seed;
  options.scene = scene;
  options.natural.on = true;
  return options;
}

double Yaw(const Rigid3& pose) {
  const Eigen::Vector3d ahead = pose.rotation * Eigen::Vector3d::UnitX();
  return std::atan2(ahead.y(), ahead.x());
}

TEST(Drive, GoesOnByAboutAStepAndTurns) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const Options options = OnItsWay(seed, Scene::kOutdoor);
    double turned = 0;
    for (int i = 0; i < 60; ++i) {
      const Rigid3 here = WorldFromLidar(options, i), next = WorldFromLidar(options, i + 1);
      EXPECT_NEAR(next.translation.x() - here.translation.x(), 0.5, 0.21);
      EXPECT_LT(std::abs(here.translation.y()), kStreetFree);
      EXPECT_LT(std::abs(Yaw(here)), 12 * kDegree);
      turned += std::abs(Yaw(next) - Yaw(here)) / 60;
    }
    EXPECT_GT(turned, 2.5 * kDegree);
    EXPECT_LT(turned, 8 * kDegree);
  }
}

TEST(Drive, StaysInTheMiddleOfTheRoom) {
  const Options options = OnItsWay(4, Scene::kIndoor);
  double least = 9, most = -9;
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d place = WorldFromLidar(options, i).translation;
    EXPECT_LT(std::abs(place.y()), kRoomFree);
    least = std::min(least, place.x());
    most = std::max(most, place.x());
  }
  EXPECT_GE(least, -kRoomFree);
  EXPECT_LE(most, kRoomFree);
  EXPECT_GT(most - least, kRoomFree);
}

TEST(Drive, IsAFunctionOfSeedAndView) {
  const Options options = OnItsWay(1, Scene::kOutdoor);
  EXPECT_EQ(WorldFromLidar(options, 7).translation, WorldFromLidar(options, 7).translation);
  EXPECT_NE(WorldFromLidar(options, 7).translation,
            WorldFromLidar(OnItsWay(2, Scene::kOutdoor), 7).translation);
}

TEST(Drive, StandsStillWithoutSteps) {
  Options options = OnItsWay(1, Scene::kOutdoor);
  options.natural.step_m = 0;
  for (const int i : {0, 5}) {
    const Rigid3 pose = WorldFromLidar(options, i);
    EXPECT_EQ(pose.translation.norm(), 0);
    EXPECT_EQ(pose.rotation.coeffs(), Eigen::Quaterniond::Identity().coeffs());
  }
}

}  // namespace
}  // namespace rgbdt::simulate
