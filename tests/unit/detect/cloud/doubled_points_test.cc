// Clouds with more than one point a beam: two returns, doubled points, several turns in one cloud.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "calib/detect/cloud/board_in_cloud.h"
#include "calib/detect/cloud/internal/ring_rows.h"
#include "calib/detect/cloud/range_grid.h"
#include "calib/simulate/internal/cloud_world.h"
#include "tests/simulated_variants.h"
#include "tests/unit/detect/cloud/pose_error.h"

namespace rgbdt {
namespace {

constexpr Utime kAtTime = 1'000'000'000;

simulate::Options SpinningPhysics(int rings, std::uint64_t seed) {
  simulate::Options options;
  options.seed = seed;
  simulate::UseLidar(rings, &options);
  options.pose.min_range_m = 2.4;
  options.pose.max_range_m = 5;
  options.pose.max_roll_rad = M_PI;
  return options;
}

BoardsInCloud BoardsOf(const Cloud& cloud, const simulate::CloudWorld& world) {
  BoardInCloudOptions options;
  options.range_sigma_m = 0.02;
  return FindBoards(cloud, world.target(), options);
}

/// The points of `cloud` in this order.
Cloud TakenOf(const Cloud& cloud, const std::vector<std::size_t>& order) {
  Cloud out;
  out.organised = false;
  out.lines = 1;
  out.beams = static_cast<int>(order.size());
  for (const std::size_t i : order) {
    out.points.push_back(cloud.points[i]);
    out.intensity.push_back(cloud.intensity[i]);
    if (!cloud.ring.empty()) out.ring.push_back(cloud.ring[i]);
  }
  return out;
}

/// One cloud after the other.
Cloud Both(Cloud first, const Cloud& second) {
  first.points.insert(first.points.end(), second.points.begin(), second.points.end());
  first.intensity.insert(first.intensity.end(), second.intensity.begin(), second.intensity.end());
  first.ring.insert(first.ring.end(), second.ring.begin(), second.ring.end());
  first.utime.clear();
  first.beams = static_cast<int>(first.size());
  return first;
}

Cloud Shuffled(const Cloud& cloud) { return TakenOf(cloud, simulate::DrawOrder(cloud.size(), 5)); }

struct Doubling {
  const char* name;
  std::function<Cloud(const Cloud&)> of;
};

/// Each `each`-th point once more: beside it, or after the others.
Cloud Doubled(const Cloud& cloud, std::size_t each, bool beside) {
  std::vector<std::size_t> order, after;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    order.push_back(i);
    if (i % each == 0) (beside ? order : after).push_back(i);
  }
  order.insert(order.end(), after.begin(), after.end());
  return TakenOf(cloud, order);
}

const Doubling kDoublings[] = {
    {"each beside it", [](const Cloud& c) { return Doubled(c, 1, true); }},
    {"all after all", [](const Cloud& c) { return Doubled(c, 1, false); }},
    {"5% after all", [](const Cloud& c) { return Doubled(c, 20, false); }},
    {"5% beside it", [](const Cloud& c) { return Doubled(c, 20, true); }},
    {"half of them, in no order", [](const Cloud& c) { return Shuffled(Doubled(c, 2, true)); }},
    {"all of them, in no order", [](const Cloud& c) { return Shuffled(Doubled(c, 1, true)); }},
    {"three times", [](const Cloud& c) { return Both(Doubled(c, 1, true), c); }},
};

/// The likeliest board of both clouds is the same, and as sure.
void ExpectTheSame(const BoardsInCloud& once, const BoardsInCloud& boards,
                   const std::string& what) {
  ASSERT_FALSE(once.candidates.empty()) << what << ": " << once.why;
  ASSERT_FALSE(boards.candidates.empty()) << what << ": " << boards.why;
  const CloudEdges& a = once.candidates[0];
  const CloudEdges& b = boards.candidates[0];
  EXPECT_EQ(a.points, b.points) << what;
  EXPECT_LT(ErrorOf(b, a.pose->sensor_from_target).norm(), 1e-5) << what;
  EXPECT_LT((a.pose->covariance - b.pose->covariance).norm(), 1e-3 * a.pose->covariance.norm())
      << what;
}

TEST(DoubledPoints, CountOnce) {
  for (const int rings : {16, 64}) {
    const simulate::CloudWorld world(SpinningPhysics(rings, 1), 0);
    for (const bool ring : {true, false}) {
      const Cloud cloud = simulate::Unorganised(world.Sweep(kAtTime), ring);
      const BoardsInCloud once = BoardsOf(cloud, world);
      for (const Doubling& doubling : kDoublings) {
        const std::string what = std::to_string(rings) + (ring ? " rings, " : ", ") + doubling.name;
        const Cloud doubled = doubling.of(cloud);
        EXPECT_FALSE(RangeGrid(doubled).scattered()) << what;
        ExpectTheSame(once, BoardsOf(doubled, world), what);
      }
    }
  }
}

// As drivers keep it of a dual return.
TEST(DoubledPoints, TheBrighterReturnOfABeamIsKept) {
  const simulate::CloudWorld world(SpinningPhysics(64, 2), 1);
  const Cloud cloud = simulate::Unorganised(world.Sweep(kAtTime), true);
  const BoardsInCloud once = BoardsOf(cloud, world);
  Cloud darker = cloud;
  for (std::size_t i = 0; i < darker.size(); ++i) {
    darker.points[i] *= i % 2 == 0 ? 0.9F : 1.1F;
    darker.intensity[i] *= 0.5F;
  }
  std::vector<std::size_t> beside;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    beside.insert(beside.end(), {i, i + cloud.size()});
    if (i % 3 == 0) std::swap(beside.back(), beside[beside.size() - 2]);
  }
  ExpectTheSame(once, BoardsOf(Both(cloud, darker), world), "darker after");
  ExpectTheSame(once, BoardsOf(Both(darker, cloud), world), "darker first");
  ExpectTheSame(once, BoardsOf(TakenOf(Both(cloud, darker), beside), world), "darker beside");
}

/// A sweep whose columns lie so many steps beside those of the rig's LIDAR.
Cloud Beside(const simulate::CloudWorld& world, const simulate::Options& options, double steps,
             Utime utime) {
  simulate::SpinningOptions spinning = *options.spinning;
  spinning.first_azimuth_rad += steps * spinning.azimuth_step_rad;
  return world.SpinningSweep(spinning, utime);
}

TEST(DoubledPoints, TwoSweepsInOneCloudAreOne) {
  constexpr double kBeside[] = {0, 0.07, 0.3, 0.5};
  struct Tally {
    double chi2 = 0;
    int found = 0;
  };
  std::map<std::string, Tally> tallies;
  int views = 0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const simulate::Options options = SpinningPhysics(64, seed);
    for (int view = 0; view < 6; ++view, ++views) {
      const simulate::CloudWorld world(options, view);
      for (const double beside : kBeside) {
        const bool ring = view % 2 == 0;
        const Cloud both =
            Both(simulate::Unorganised(Beside(world, options, 0, kAtTime), ring),
                 simulate::Unorganised(Beside(world, options, beside, kAtTime + 100'000), ring));
        const auto boards = BoardsOf(both, world);
        if (boards.candidates.empty()) continue;
        Tally& tally = tallies[std::to_string(beside)];
        const Vector6d error = ErrorOf(boards.candidates[0], world.lidar_from_target());
        EXPECT_LT(error.head<3>().norm(), 0.03);
        tally.chi2 += error.dot(boards.candidates[0].pose->covariance.ldlt().solve(error));
        ++tally.found;
      }
    }
  }
  EXPECT_EQ(tallies.size(), std::size(kBeside));
  for (const auto& [beside, tally] : tallies) {
    EXPECT_GE(tally.found, views - 1) << beside;
    // Six degrees of freedom; the mean of 18 has sigma sqrt(12 / 18) = 0.8.
    EXPECT_LT(tally.chi2 / tally.found, 6 + 3 * 0.8) << beside;
    EXPECT_GT(tally.chi2 / tally.found, 2.5) << beside;
  }
}

// Drivers that cut sweeps by packets give some degrees twice.
TEST(DoubledPoints, ASweepOfMoreThanATurn) {
  const simulate::Options options = SpinningPhysics(64, 3);
  const simulate::CloudWorld world(options, 0);
  const Cloud first = Beside(world, options, 0, kAtTime);
  const Cloud second = Beside(world, options, 0.4, kAtTime + 100'000);
  const BoardsInCloud once = BoardsOf(simulate::Unorganised(first, true), world);
  std::vector<std::size_t> more;
  for (std::size_t i = 0; i < second.size(); ++i) {
    const auto columns = static_cast<std::size_t>(second.beams);
    if (second.IsHit(i) && i % columns < columns / 20) more.push_back(i);
  }
  const Cloud cloud = Both(simulate::Unorganised(first, true), TakenOf(second, more));
  EXPECT_FALSE(RangeGrid(cloud).scattered());
  ExpectTheSame(once, BoardsOf(cloud, world), "5% more");
}

// Where part of a sweep was lost, the next one has it.
TEST(DoubledPoints, WhatTheFirstTurnLeftOutIsTakenOfTheNext) {
  const simulate::Options options = SpinningPhysics(64, 3);
  const simulate::CloudWorld world(options, 0);
  const Cloud second = simulate::Unorganised(Beside(world, options, 0, kAtTime), true);
  const Eigen::Vector3d board = world.lidar_from_target().translation;
  std::vector<std::size_t> first;
  for (std::size_t i = 0; i < second.size(); ++i) {
    const Eigen::Vector2f p = second.points[i].head<2>();
    if (p.normalized().dot(board.head<2>().normalized().cast<float>()) < 0.98F) first.push_back(i);
  }
  const Cloud lost = TakenOf(second, first);
  ASSERT_TRUE(BoardsOf(lost, world).candidates.empty());
  ExpectTheSame(BoardsOf(second, world), BoardsOf(Both(lost, second), world), "lost once");
}

TEST(DoubledPoints, AreTheReasonWhereTheyCannotBeToldApart) {
  const simulate::Options options = SpinningPhysics(64, 4);
  const simulate::CloudWorld world(options, 0);
  Cloud many = simulate::Unorganised(Beside(world, options, 0, kAtTime), true);
  for (const char* part : {"50%", "67%"}) {
    const double beside = part[0] == '5' ? 0.3 : 0.41;
    many = Both(std::move(many),
                simulate::Unorganised(Beside(world, options, beside, kAtTime + 100'000), true));
    const BoardsInCloud boards = BoardsOf(Shuffled(many), world);
    ASSERT_TRUE(boards.candidates.empty()) << part;
    EXPECT_THAT(boards.why,
                ::testing::HasSubstr(part + std::string(" of the points share a beam")));
  }
}

// Neighbours are at any distance there: close ones are two beams.
TEST(DoubledPoints, AreNotSeenWherePointsWereTakenOutAtRandom) {
  const simulate::Options options = SpinningPhysics(64, 1);
  const simulate::CloudWorld world(options, 0);
  Cloud cloud = simulate::Unorganised(Beside(world, options, 0, kAtTime), true);
  for (const double beside : {0.2, 0.45, 0.7}) {
    cloud = Both(std::move(cloud),
                 simulate::Unorganised(Beside(world, options, beside, kAtTime), true));
  }
  std::vector<std::size_t> order = simulate::DrawOrder(cloud.size(), 3);
  order.resize(order.size() / 8);
  const Cloud few = TakenOf(cloud, order);
  const auto found = FindRingRows(few, AnglesOf(few));
  ASSERT_TRUE(found);
  std::size_t in_rows = 0;
  for (const auto& row : found->rows) in_rows += row.size();
  EXPECT_EQ(in_rows, few.size());
}

}  // namespace
}  // namespace rgbdt
