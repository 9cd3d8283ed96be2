#include "calib/methods/scene/pose_search.h"

#include "calib/methods/scene/particle_swarm.h"
#include "tests/unit/matchers.h"

namespace rgbdt {
namespace {

using testing::HasSubstr;

const PoseSteps kSteps{0.01, 0.05};

// A paraboloid about a pose, 0 there.
PoseObjective HillAt(const Rigid3& top) {
  return [top](const Rigid3& pose) { return -StepsBetween(top, pose, kSteps).squaredNorm(); };
}

TEST(PoseSearch, StepsBetweenUndoesMoved) {
  Random random(1);
  const Rigid3 pose = random.Pose();
  Vector6d count;
  count << 1, -2, 0.5, 3, -1, 2;
  EXPECT_THAT(StepsBetween(pose, Moved(pose, count, kSteps), kSteps), EigenNear(count, 1e-9));
}

TEST(PoseSearch, AllNeighboursOfAPeakAreWorseAndOfASlopeHalf) {
  const Rigid3 pose = Random(2).Pose();
  EXPECT_EQ(ShareWorse(HillAt(pose), pose, kSteps), 1);
  const PoseObjective slope = [&](const Rigid3& other) {
    return StepsBetween(pose, other, kSteps)[0];
  };
  // A third lies below, a third as high, up to rounding.
  EXPECT_GT(ShareWorse(slope, pose, kSteps), 0.3);
  EXPECT_LT(ShareWorse(slope, pose, kSteps), 0.7);
  const PoseObjective flat = [](const Rigid3&) { return 1.0; };
  EXPECT_EQ(ShareWorse(flat, pose, kSteps), 0);
  EXPECT_THAT(WhyNoPeak(0.5, 0.9, kSteps), HasSubstr("only 50%"));
  EXPECT_EQ(WhyNoPeak(0.95, 0.9, kSteps), "");
}

TEST(ParticleSwarm, FindsTheTopInItsBox) {
  const Rigid3 start = Random(3).Pose();
  Vector6d away;
  away << 2, -1, 0.5, -0.4, 0.8, 0.1;
  const Rigid3 top = Moved(start, away, kSteps);
  SwarmOptions options;
  options.rounds = 150;
  const SwarmResult found = MaximiseBySwarm(HillAt(top), start, options);
  EXPECT_THAT(found.pose, Rigid3Near(top, 1e-4, 1e-3));
  EXPECT_FALSE(found.at_border);
}

TEST(ParticleSwarm, SaysThatTheTopLiesBeyondItsBox) {
  const Rigid3 start = Random(4).Pose();
  const Rigid3 top = Moved(start, 20 * Vector6d::Unit(1), kSteps);
  EXPECT_TRUE(MaximiseBySwarm(HillAt(top), start, SwarmOptions()).at_border);
}

TEST(ParticleSwarm, TheSameSeedGivesTheSameBits) {
  const Rigid3 start = Random(5).Pose();
  const PoseObjective hill = HillAt(Moved(start, Vector6d::Ones(), kSteps));
  SwarmOptions options;
  options.rounds = 10;
  const SwarmResult once = MaximiseBySwarm(hill, start, options);
  EXPECT_EQ(once.value, MaximiseBySwarm(hill, start, options).value);
  options.seed = 2;
  EXPECT_NE(once.value, MaximiseBySwarm(hill, start, options).value);
}

TEST(ParticleSwarm, RefusesAnEmptyBox) {
  SwarmOptions options;
  options.reach.translation_m = 0;
  EXPECT_THAT(InputErrorOf([&] { options.Check(); }), HasSubstr("reach"));
}

}  // namespace
}  // namespace rgbdt
