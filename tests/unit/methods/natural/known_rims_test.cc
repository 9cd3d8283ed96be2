#include "calib/methods/natural/known_rims.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace rgbdt {
namespace {

using Eigen::Vector3d;
using ::testing::Each;

// A post's left (-1) or right (1) rim in the world, from z = `from` to `to`, as a LIDAR sees it.
std::vector<SceneEdge> Rim(const Rigid3& world_from_lidar, const Vector3d& foot, int side,
                           double from = 0, double to = 2, int number = 0) {
  std::vector<SceneEdge> edges;
  const Rigid3 lidar_from_world = world_from_lidar.Inverse();
  for (double z = from; z <= to; z += 0.05) {
    SceneEdge edge;
    edge.point = lidar_from_world * Vector3d(foot + Vector3d(0, 0, z));
    edge.across = lidar_from_world.rotation * Vector3d(0, -0.01 * side, 0);
    edge.along = lidar_from_world.rotation * Vector3d::UnitZ();
    edge.place = 3;
    edge.rim = edge.thing = number;
    edges.push_back(edge);
  }
  return edges;
}

// Of each edge, which rim of the world it is of.
std::vector<int> RimsOf(KnownRims* known, const std::vector<SceneEdge>& edges,
                        const ShotPlace& place) {
  std::vector<int> rims;
  for (const int met : known->Add(edges, place)) {
    rims.push_back(known->rims().at(static_cast<std::size_t>(met)).rim);
  }
  return rims;
}

const Vector3d kFoot(6, 1, -1);
const Rigid3 kElsewhere = Rigid3{Eigen::Quaterniond::Identity(), Vector3d(2, -1, 0)} *
                          RotationAbout(Vector3d::UnitZ(), 0.4);

TEST(KnownRims, OneIsKnownAgainFromElsewhere) {
  KnownRims known;
  EXPECT_THAT(RimsOf(&known, Rim({}, kFoot, 1), {}), Each(0));
  EXPECT_THAT(RimsOf(&known, Rim({}, kFoot, 1), {}), Each(0));
  EXPECT_EQ(known.rims().size(), 1U) << "the same beams, with the same error";
  EXPECT_THAT(RimsOf(&known, Rim(kElsewhere, kFoot, 1), {0, kElsewhere}), Each(0));
  EXPECT_EQ(known.rims().size(), 2U) << "other beams";
  EXPECT_EQ(known.rims()[0].thing, known.rims()[1].thing);
  // Its edges lie in one place between beams: their error is one and the same.
  EXPECT_NEAR(known.rims()[0].common_rad, 0.01 / kFoot.norm() / std::sqrt(3.0), 1e-4);
}

TEST(KnownRims, AlsoWhereAPartOfItIsSeen) {
  KnownRims known;
  known.Add(Rim({}, kFoot, 1, 0, 1.2), {});
  EXPECT_THAT(RimsOf(&known, Rim(kElsewhere, kFoot, 1, 0.6, 2), {0, kElsewhere}), Each(0));
  // What lies far from what was seen is another one, although a line of it goes on.
  EXPECT_THAT(RimsOf(&known, Rim({}, kFoot, 1, 3, 5), {}), Each(1));
}

TEST(KnownRims, AThingsOtherSideIsAnotherRimOfIt) {
  KnownRims known;
  std::vector<SceneEdge> both = Rim({}, kFoot, 1);
  for (SceneEdge edge : Rim({}, kFoot + Vector3d(0, 0.05, 0), -1)) {
    edge.rim = 1;
    both.push_back(edge);
  }
  const std::vector<int> numbers = known.Add(both, {});
  EXPECT_NE(numbers.front(), numbers.back());
  EXPECT_EQ(known.rims()[0].thing, known.rims()[1].thing);
  EXPECT_EQ(known.Add(both, {}), numbers);
}

TEST(KnownRims, OfAnotherWorldNothingIsKnown) {
  KnownRims known;
  EXPECT_THAT(RimsOf(&known, Rim({}, kFoot, 1), {}), Each(0));
  EXPECT_THAT(RimsOf(&known, Rim({}, kFoot, 1), {1, {}}), Each(1));
  EXPECT_NE(known.rims()[0].thing, known.rims()[1].thing);
}

TEST(KnownRims, PlacesThatAreNoneHarmNothing) {
  KnownRims known;
  const double huge = 1e300;
  const Rigid3 far{Eigen::Quaterniond::Identity(), Vector3d(huge, -huge, huge)};
  known.Add(Rim({}, kFoot, 1), {0, far});
  const std::vector<SceneEdge> edges = Rim({}, kFoot, 1);
  EXPECT_EQ(known.Add(edges, {0, far}).size(), edges.size());
}

}  // namespace
}  // namespace rgbdt
