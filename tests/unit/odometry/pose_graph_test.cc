#include "calib/odometry/internal/pose_graph.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "calib/model/errors.h"

namespace rgbdt {
namespace {

using odometry::PoseEdge;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr std::size_t kPoses = 60;

Matrix6d Covariance(double turn_rad, double place_m) {
  Vector6d sigma;
  sigma << Eigen::Vector3d::Constant(turn_rad), Eigen::Vector3d::Constant(place_m);
  return sigma.cwiseAbs2().asDiagonal();
}

// Once round a circle of 60 m.
Rigid3 Truth(std::size_t i) {
  const double angle = 2 * M_PI * static_cast<double>(i) / kPoses;
  Rigid3 pose = RotationAbout(Eigen::Vector3d::UnitZ(), angle);
  pose.translation = 60 / (2 * M_PI) * Eigen::Vector3d(std::sin(angle), 1 - std::cos(angle), 0);
  return pose;
}

PoseEdge Edge(std::size_t from, std::size_t to, const Matrix6d& covariance) {
  return {from, to, Truth(from).Inverse() * Truth(to), covariance};
}

// A chain whose every edge is off by the same: turned, and 0.5% too steep. (A circle of edges that
// are all too long closes as well.)
struct Drifted {
  std::vector<Rigid3> poses{Truth(0)};
  std::vector<PoseEdge> chain;

  Drifted() {
    Vector6d off;
    off << 2e-4, -1e-4, 1e-3, 0, 0, 0.005;
    for (std::size_t i = 0; i + 1 < kPoses; ++i) {
      PoseEdge edge = Edge(i, i + 1, Covariance(1e-3, 0.01));
      edge.from_from_to = edge.from_from_to * Exp(off);
      poses.push_back(poses.back() * edge.from_from_to);
      chain.push_back(edge);
    }
  }
};

double Farthest(const std::vector<Rigid3>& poses) {
  double most = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    most = std::max(most, (poses[i].translation - Truth(i).translation).norm());
  }
  return most;
}

TEST(PoseGraph, ALoopTakesKnownDriftOut) {
  const Drifted drifted;
  const double before = Farthest(drifted.poses);
  EXPECT_GT(before, 0.5);
  const auto graph = SolveGraph(
      drifted.poses, drifted.chain,
      {Edge(0, kPoses - 1, Covariance(1e-4, 0.001)), Edge(1, kPoses - 2, Covariance(1e-4, 0.001))});
  ASSERT_TRUE(graph);
  EXPECT_THAT(graph->kept, ElementsAre(0, 1));
  EXPECT_LT(Farthest(graph->poses), 0.25 * before);
  EXPECT_LT((graph->poses.back().translation - Truth(kPoses - 1).translation).norm(), 0.01);
  EXPECT_EQ((graph->poses.front().Inverse() * Truth(0)).translation.norm(), 0);
}

TEST(PoseGraph, WhatIsKnownBetterMovesLess) {
  Drifted drifted;
  // The last third is known ten times better: the loop's share goes to the others.
  for (std::size_t i = 40; i + 1 < kPoses; ++i) drifted.chain[i].covariance *= 0.01;
  const auto graph =
      SolveGraph(drifted.poses, drifted.chain, {Edge(0, kPoses - 1, Covariance(1e-4, 0.001))});
  ASSERT_TRUE(graph);
  const auto changed = [&](std::size_t i) {
    const Rigid3 now = graph->poses[i].Inverse() * graph->poses[i + 1];
    return Log(drifted.chain[i].from_from_to.Inverse() * now).norm();
  };
  EXPECT_GT(changed(10), 10 * changed(50));
}

TEST(PoseGraph, AWrongLoopIsRefusedAndTheRightOnesAreKept) {
  const Drifted drifted;
  const Matrix6d loop = Covariance(1e-4, 0.001);
  std::vector<PoseEdge> loops;
  for (std::size_t i = 0; i < 5; ++i) loops.push_back(Edge(i, kPoses - 1 - i, loop));
  const auto right = SolveGraph(drifted.poses, drifted.chain, loops);
  // The other side of the circle looks like the start.
  loops.insert(loops.begin() + 2, {0, 30, Rigid3{}, loop});
  const auto graph = SolveGraph(drifted.poses, drifted.chain, loops);
  ASSERT_TRUE(right && graph);
  EXPECT_THAT(graph->kept, ElementsAre(0, 1, 3, 4, 5));
  EXPECT_EQ(Farthest(graph->poses), Farthest(right->poses));
}

// As many wrong loops as right ones: least squares would take the middle.
TEST(PoseGraph, WrongLoopsThatAgreeWithNothingDoNotBendTheWay) {
  const Drifted drifted;
  const Matrix6d loop = Covariance(1e-4, 0.001);
  std::vector<PoseEdge> loops;
  for (std::size_t i = 0; i < 4; ++i) loops.push_back(Edge(i, kPoses - 1 - i, loop));
  const auto right = SolveGraph(drifted.poses, drifted.chain, loops);
  for (std::size_t i = 0; i < 4; ++i) loops.push_back({3 * i, 30 + i * i, Rigid3{}, loop});
  const auto graph = SolveGraph(drifted.poses, drifted.chain, loops);
  ASSERT_TRUE(right && graph);
  EXPECT_THAT(graph->kept, ElementsAre(0, 1, 2, 3));
  EXPECT_EQ(Farthest(graph->poses), Farthest(right->poses));
}

TEST(PoseGraph, AnEdgeGoneBackAndForthIsNone) {
  const PoseEdge edge = Edge(3, 9, Covariance(0.01, 0.1));
  const PoseEdge back = Inverted(edge);
  EXPECT_EQ(back.from, 9U);
  EXPECT_LT(Log(edge.from_from_to * back.from_from_to).norm(), 1e-12);
  EXPECT_LT((Inverted(back).covariance - edge.covariance).norm(), 1e-12);
  EXPECT_GT((back.covariance - edge.covariance).norm(), 1e-3);
}

TEST(PoseGraph, WithoutALoopNothingMoves) {
  const Drifted drifted;
  const auto graph = SolveGraph(drifted.poses, drifted.chain, {});
  ASSERT_TRUE(graph);
  EXPECT_THAT(graph->kept, IsEmpty());
  EXPECT_EQ(Farthest(graph->poses), Farthest(drifted.poses));
}

TEST(PoseGraph, AnEdgeToNowhereIsNamed) {
  const Drifted drifted;
  try {
    SolveGraph(drifted.poses, drifted.chain, {{0, kPoses, {}, Covariance(1, 1)}});
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(std::string(e.what()), HasSubstr("from pose 0 to 60; there are 60"));
  }
}

TEST(PoseGraph, CovariancesOfAChainAddUpWhereItEnds) {
  // A turn of the first edge moves the end by its distance.
  PoseEdge first{0, 1, {}, Covariance(0.01, 0.001)}, second{1, 2, {}, Covariance(0, 0.001)};
  second.from_from_to.translation = {10, 0, 0};
  const PoseEdge both = Chained(first, second);
  EXPECT_EQ(both.to, 2U);
  EXPECT_NEAR(both.covariance(4, 4), 0.1 * 0.1 + 2e-6, 1e-9);
  EXPECT_NEAR(both.covariance(3, 3), 2e-6, 1e-9);
  PoseEdge off = both;
  off.covariance = Covariance(1e-9, 1e-9);
  off.from_from_to = RotationAbout(Eigen::Vector3d::UnitZ(), 0.005) * both.from_from_to;
  EXPECT_NEAR(ChiSquare(both, off), 0.5 * 0.5, 0.02);
  off.from_from_to = both.from_from_to;
  off.from_from_to.translation.y() += 0.05;  // without the turn that goes with it
  EXPECT_GT(ChiSquare(both, off), 100);
}

}  // namespace
}  // namespace rgbdt
