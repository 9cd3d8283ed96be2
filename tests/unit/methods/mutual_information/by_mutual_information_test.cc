#include "calib/methods/mutual_information/by_mutual_information.h"

#include "tests/numbers.h"
#include "tests/unit/methods/scene/scene_world.h"

namespace rgbdt {
namespace {

using testing::HasSubstr;

TEST(ReflectivityAgainstGrey, IsLargestAtTheTruth) {
  const SceneWorld world(2);
  const Rigid3& truth = world.Truth(0);
  const ReflectivityAgainstGrey values(world.rig().cameras[0], world.Shots(0), truth, {});
  const Entropies there = values.EntropiesAt(truth);
  for (const Rigid3& turned : TurnedTwoDegrees(truth)) {
    const Entropies here = values.EntropiesAt(turned);
    EXPECT_LT(here.MutualInformation(), there.MutualInformation());
    EXPECT_LT(here.Normalised(), there.Normalised());
  }
}

TEST(AlignByMutualInformation, EndsNearerThanItBegan) {
  const SceneWorld world(4);
  const Rigid3& truth = world.Truth(0);
  const Rigid3 start = GuessOff(truth, 1 * kDegree, 0.03, 5);
  MutualInformationOptions options;
  options.most_points = 10000;
  const SceneFit fit =
      AlignByMutualInformation(world.rig().cameras[0], world.Shots(0), start, options);
  EXPECT_TRUE(fit.converged) << fit.why_not;
  EXPECT_LT(RotationDistance(fit.camera_from_lidar, truth), 0.4 * kDegree);
}

TEST(AlignByNormalisedMutualInformation, EndsNearerThanItBegan) {
  const SceneWorld world(4);
  const Rigid3& truth = world.Truth(0);
  const Rigid3 start = GuessOff(truth, 1 * kDegree, 0.03, 5);
  MutualInformationOptions options;
  options.most_points = 10000;
  options.swarm.rounds = 40;
  const SceneFit fit =
      AlignByNormalisedMutualInformation(world.rig().cameras[0], world.Shots(0), start, options);
  EXPECT_TRUE(fit.converged) << fit.why_not;
  EXPECT_LT(RotationDistance(fit.camera_from_lidar, truth), 0.4 * kDegree);
}

TEST(AlignByMutualInformation, SaysThatACameraLooksElsewhere) {
  const SceneWorld world(1);
  const Rigid3 away = LookingAway(world.Truth(0));
  for (const auto align : {AlignByMutualInformation, AlignByNormalisedMutualInformation}) {
    const SceneFit fit = align(world.rig().cameras[0], world.Shots(0), away, {});
    EXPECT_FALSE(fit.converged);
    EXPECT_THAT(fit.why_not, HasSubstr("points lie in the images"));
  }
}

TEST(AlignByMutualInformation, SaysThatACloudHasNoIntensities) {
  SceneWorld world(1);
  world.clouds[0].intensity.clear();
  const SceneFit fit =
      AlignByMutualInformation(world.rig().cameras[0], world.Shots(0), world.Truth(0));
  EXPECT_FALSE(fit.converged);
  EXPECT_THAT(fit.why_not, HasSubstr("has no intensities"));
}

TEST(AlignByMutualInformation, NoiseIsNoPeak) {
  SceneWorld world(1);
  Random random(1);
  for (float& value : world.clouds[0].intensity) value = static_cast<float>(random.Uniform(0, 1));
  const SceneFit fit =
      AlignByMutualInformation(world.rig().cameras[0], world.Shots(0), world.Truth(0));
  EXPECT_FALSE(fit.converged);
  EXPECT_FALSE(fit.why_not.empty());
}

TEST(AlignByMutualInformation, RefusesAnotherCamerasImage) {
  const SceneWorld world(1);
  EXPECT_THAT(InputErrorOf([&] {
                AlignByMutualInformation(world.rig().cameras[0], world.Shots(1), world.Truth(0));
              }),
              HasSubstr("the rig file says"));
}

}  // namespace
}  // namespace rgbdt
