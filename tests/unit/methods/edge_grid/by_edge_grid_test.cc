#include "calib/methods/edge_grid/by_edge_grid.h"

#include "tests/numbers.h"
#include "tests/unit/methods/scene/scene_world.h"

namespace rgbdt {
namespace {

using testing::HasSubstr;

TEST(EdgesOnEdges, IsLargestAtTheTruth) {
  const SceneWorld world(2);
  const Rigid3& truth = world.Truth(0);
  const EdgesOnEdges edges(world.rig().cameras[0], world.Shots(0), truth, {});
  for (const Rigid3& turned : TurnedTwoDegrees(truth)) {
    EXPECT_LT(edges.At(turned).value, edges.At(truth).value);
  }
}

TEST(AlignByEdgeGrid, EndsNearerThanItBegan) {
  const SceneWorld world(4);
  const Rigid3& truth = world.Truth(0);
  const Rigid3 start = GuessOff(truth, 1 * kDegree, 0.03, 5);
  const SceneFit fit = AlignByEdgeGrid(world.rig().cameras[0], world.Shots(0), start);
  EXPECT_TRUE(fit.converged) << fit.why_not;
  EXPECT_LT(RotationDistance(fit.camera_from_lidar, truth), 0.5 * kDegree);
}

TEST(AlignByEdgeGrid, SaysThatACameraLooksElsewhere) {
  const SceneWorld world(1);
  const SceneFit fit =
      AlignByEdgeGrid(world.rig().cameras[0], world.Shots(0), LookingAway(world.Truth(0)));
  EXPECT_FALSE(fit.converged);
  EXPECT_THAT(fit.why_not, HasSubstr("points at depth discontinuities lie in the images"));
}

TEST(AlignByEdgeGrid, AnEvenImageIsNoPeak) {
  SceneWorld world(1);
  world.images[0].pixels.setTo(100);
  const SceneFit fit = AlignByEdgeGrid(world.rig().cameras[0], world.Shots(0), world.Truth(0));
  EXPECT_FALSE(fit.converged);
  EXPECT_FALSE(fit.why_not.empty());
}

TEST(AlignByEdgeGrid, RefusesAGammaThatReachesEverywhere) {
  EdgeGridOptions options;
  options.gamma = 1;
  EXPECT_THAT(InputErrorOf([&] { options.Check(); }), HasSubstr("gamma"));
}

}  // namespace
}  // namespace rgbdt
