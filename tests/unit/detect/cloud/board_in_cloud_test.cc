#include "calib/detect/cloud/board_in_cloud.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <set>

#include "calib/model/errors.h"
#include "calib/simulate/internal/board.h"
#include "calib/simulate/internal/cloud_world.h"
#include "calib/simulate/internal/spinning.h"
#include "calib/simulate/use_target.h"
#include "tests/simulated_variants.h"
#include "tests/unit/detect/cloud/pose_error.h"

namespace rgbdt {
namespace {

using simulate::CloudWorld;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr Utime kSweepTime = 1'000'000'000;

// rings 0: the turned scanner.
simulate::Options Physics(int rings, std::uint64_t seed = 1) {
  simulate::Options options;
  options.seed = seed;
  if (rings > 0) simulate::UseLidar(rings, &options);
  options.pose.min_range_m = 2.4;
  options.pose.max_range_m = rings == 16 ? 4 : 6;
  options.pose.max_roll_rad = M_PI;
  return options;
}

BoardInCloudOptions Detection(int rings) {
  BoardInCloudOptions options;
  options.range_sigma_m = rings > 0 ? 0.02 : 0.01;
  return options;
}

double CentreError(const CloudEdges& found, const Rigid3& truth) {
  return (found.pose->sensor_from_target.translation - truth.translation).norm();
}

/// A found board's tilt against the truth: about its own x and y, squared [rad^2], and over its
/// covariance.
struct Tilt {
  double squared = 0, chi2 = 0;
};

Tilt TiltOf(const CloudEdges& found, const Rigid3& truth) {
  const TargetPose& pose = *found.pose;
  const Eigen::Matrix3d r = pose.sensor_from_target.Inverse().rotation.toRotationMatrix();
  const Eigen::Vector2d tilt = (r * ErrorOf(found, truth).head<3>()).head<2>();
  const Eigen::Matrix2d covariance =
      (r * pose.covariance.topLeftCorner<3, 3>() * r.transpose()).topLeftCorner<2, 2>();
  return {tilt.squaredNorm(), tilt.dot(covariance.ldlt().solve(tilt))};
}

// The board of velo2cam and FAST-Calib, 1.4 x 1.0 m.
simulate::Options WithHoles(simulate::Options options) {
  simulate::UseTarget(BoardWithHoles(Markers{kHolesFamily, 0.16, 1, 0, false}), &options.board);
  return options;
}

class AnyLidar : public ::testing::TestWithParam<int> {};

TEST_P(AnyLidar, FindsABoardWithHoles) {
  for (int view = 0; view < 3; ++view) {
    const CloudWorld world(WithHoles(Physics(GetParam())), view);
    const Cloud cloud = world.Sweep(kSweepTime);
    const auto boards = FindBoards(cloud, world.target(), Detection(GetParam()));
    ASSERT_FALSE(boards.candidates.empty()) << "view " << view << ": " << boards.why;
    const Vector6d error = ErrorOf(boards.candidates[0], world.lidar_from_target());
    EXPECT_LT(error.head<3>().norm(), 0.03) << "view " << view;
    EXPECT_LT(CentreError(boards.candidates[0], world.lidar_from_target()), 0.06) << view;
    // A board without them is none.
    simulate::Options filled = WithHoles(Physics(GetParam()));
    filled.board.holes.reset();
    filled.board.markers.reset();
    const CloudWorld other(filled, view);
    EXPECT_TRUE(FindBoards(other.Sweep(kSweepTime), world.target(), Detection(GetParam()))
                    .candidates.empty())
        << view;
  }
}

TEST_P(AnyLidar, FindsTheBoardInTheWholeCloud) {
  for (int view = 0; view < 6; ++view) {
    const CloudWorld world(Physics(GetParam()), view);
    const auto boards = FindBoards(world.Sweep(kSweepTime), world.target(), Detection(GetParam()));
    ASSERT_FALSE(boards.candidates.empty()) << "view " << view << ": " << boards.why;
    const Vector6d error = ErrorOf(boards.candidates[0], world.lidar_from_target());
    EXPECT_LT(error.head<3>().norm(), 0.03) << "view " << view;
    EXPECT_LT(CentreError(boards.candidates[0], world.lidar_from_target()), 0.06) << view;
  }
}

TEST_P(AnyLidar, OrderAndMissesAndRingsAreNotNeeded) {
  const CloudWorld world(Physics(GetParam(), 2), 1);
  const Cloud sweep = world.Sweep(kSweepTime);
  for (const bool keep_ring : {true, false}) {
    const Cloud loose = simulate::Unorganised(sweep, keep_ring, 7);
    ASSERT_FALSE(loose.organised);
    const auto boards = FindBoards(loose, world.target(), Detection(GetParam()));
    ASSERT_FALSE(boards.candidates.empty()) << boards.why;
    EXPECT_LT(CentreError(boards.candidates[0], world.lidar_from_target()), 0.06);
  }
}

INSTANTIATE_TEST_SUITE_P(Rings, AnyLidar, ::testing::Values(0, 16, 32, 64, 128));

TEST(BoardInCloud, ItsCovarianceIsThatOfItsErrors) {
  for (const int rings : {0, 16, 32}) {
    double chi2 = 0;
    int count = 0;
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
      for (int view = 0; view < 6; ++view) {
        const CloudWorld world(Physics(rings, seed), view);
        const auto boards = FindBoards(world.Sweep(kSweepTime), world.target(), Detection(rings));
        if (boards.candidates.empty()) continue;
        const Vector6d error = ErrorOf(boards.candidates[0], world.lidar_from_target());
        chi2 += error.dot(boards.candidates[0].pose->covariance.ldlt().solve(error));
        ++count;
      }
    }
    ASSERT_GE(count, 34);
    // Six degrees of freedom; the mean of 36 has sigma sqrt(12 / 36) = 0.6. The priors of what the
    // beam does to an edge are wider than this one simulator's, so below 6 is to be expected.
    EXPECT_LT(chi2 / count, 6 + 3 * 0.6) << rings;
    EXPECT_GT(chi2 / count, 2.5) << rings;
  }
}

TEST(BoardInCloud, ATiltedBoardsPlaneDoesNotLean) {
  // Noise lies along the beams: the plane of least distances would lean by a third of a
  // milliradian here, five times its sigma (see PlaneAlongRays).
  simulate::Options options = Physics(0);
  options.scanner = simulate::DenseScanner();
  options.pose.min_range_m = options.pose.max_range_m = 2.5;
  double chi2 = 0;
  constexpr int kViews = 6;
  for (int view = 0; view < kViews; ++view) {
    const CloudWorld world(options, view);
    const auto boards = FindBoards(world.Sweep(kSweepTime), world.target(), Detection(0));
    ASSERT_FALSE(boards.candidates.empty()) << boards.why;
    chi2 += TiltOf(boards.candidates[0], world.lidar_from_target()).chi2;
  }
  // Two degrees of freedom a view: the mean of six has sigma 0.8.
  EXPECT_LT(chi2 / kViews, 2 + 3.5 * 0.8);
}

/// Of many boards' tilts: the mean of their squares, and of their chi-squares (2 each).
struct Tilts {
  double squared = 0, chi2 = 0;
  int views = 0;

  void Add(const Cloud& cloud, const CloudWorld& world) {
    const auto boards = FindBoards(cloud, world.target(), Detection(32));
    if (boards.candidates.empty()) return;
    const Tilt tilt = TiltOf(boards.candidates[0], world.lidar_from_target());
    squared += tilt.squared;
    chi2 += tilt.chi2;
    ++views;
  }
};

TEST(BoardInCloud, NoisierDarkPointsCountForLess) {
  Tilts weighed, alike;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    simulate::Options options = Physics(32, seed);
    options.spinning->dark_noise = 5;
    for (int view = 0; view < 6; ++view) {
      const CloudWorld world(options, view);
      Cloud cloud = world.Sweep(kSweepTime);
      weighed.Add(cloud, world);
      cloud.intensity.clear();
      alike.Add(cloud, world);
    }
  }
  ASSERT_GE(weighed.views, 34);
  ASSERT_GE(alike.views, 34);
  // Half of the points with 25 times the variance: 13 times as large if all count alike.
  EXPECT_LT(weighed.squared / weighed.views, 0.5 * alike.squared / alike.views);
  // Two degrees of freedom a view: the mean of 36 has sigma 0.33.
  EXPECT_LT(weighed.chi2 / weighed.views, 2 + 3 * 0.33);
  EXPECT_GT(weighed.chi2 / weighed.views, 2 - 3 * 0.33);
}

TEST(BoardInCloud, NoiseThatNeighboursShareIsCountedOnce) {
  constexpr double kAlike = 0.6, kSigmaM = 0.02;
  Tilts tilts;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    simulate::Options options = Physics(32, seed);
    options.spinning->range_sigma_m = 1e-6;
    std::mt19937 random(static_cast<unsigned>(seed));
    std::normal_distribution<float> normal;
    for (int view = 0; view < 6; ++view) {
      const CloudWorld world(options, view);
      Cloud cloud = world.Sweep(kSweepTime);
      float noise = 0;
      for (Eigen::Vector3f& point : cloud.points) {
        noise = static_cast<float>(kAlike) * noise +
                static_cast<float>(std::sqrt(1 - kAlike * kAlike)) * normal(random);
        point += static_cast<float>(kSigmaM) * noise * point.normalized();
      }
      tilts.Add(cloud, world);
    }
  }
  ASSERT_GE(tilts.views, 34);
  // As if independent, they would be twice as sure as they are: 8 for 2. Sigma as above.
  EXPECT_LT(tilts.chi2 / tilts.views, 2 + 3 * 0.33);
  EXPECT_GT(tilts.chi2 / tilts.views, 2 - 3 * 0.33);
}

TEST(BoardInCloud, WhatLooksAlikeIsNoBoard) {
  for (const int rings : {0, 32}) {
    simulate::Options options = Physics(rings, 3);
    options.clutter.door = options.clutter.poster = options.clutter.table = true;
    // 7% too large: 32 rings cannot tell it from the board far away, only the views together can.
    options.clutter.panel = rings == 0;
    options.clutter.max_azimuth_rad = 80 * simulate::kDegree;
    const CloudWorld world(options, 0);
    const auto boards = FindBoards(world.Sweep(kSweepTime), world.target(), Detection(rings));
    ASSERT_FALSE(boards.candidates.empty()) << boards.why;
    EXPECT_LT(CentreError(boards.candidates[0], world.lidar_from_target()), 0.06);
    const CloudWorld without(options, std::nullopt);
    EXPECT_TRUE(
        FindBoards(without.Sweep(kSweepTime), world.target(), Detection(rings)).candidates.empty())
        << rings;
  }
}

TEST(BoardInCloud, OfOneLaserNoRingIsTold) {
  const CloudWorld world(Physics(0, 4), 0);
  Cloud cloud = world.Sweep(kSweepTime);
  ASSERT_EQ(cloud.ring.size(), cloud.size());
  for (std::uint16_t& ring : cloud.ring) ring = static_cast<std::uint16_t>(ring / 8);  // few beams
  BoardInCloudOptions options = Detection(0);
  for (const bool one_laser : {false, true}) {
    options.one_laser = one_laser;
    const auto boards = FindBoards(cloud, world.target(), options);
    ASSERT_FALSE(boards.candidates.empty()) << boards.why;
    for (const PointGroup& group : boards.candidates[0].groups) {
      EXPECT_EQ(group.ring < 0, one_laser);
    }
  }
  LidarSpec lidar;
  EXPECT_FALSE(OptionsFor(lidar).one_laser);
  lidar.turned_scanner.emplace();
  EXPECT_TRUE(OptionsFor(lidar).one_laser);
}

TEST(BoardInCloud, ASecondBoardIsACandidateToo) {
  simulate::Options options = Physics(0, 4);
  options.clutter.second_board = true;
  options.clutter.max_azimuth_rad = 28 * simulate::kDegree;
  const CloudWorld world(options, 0);  // where neither hides the other
  const auto boards = FindBoards(world.Sweep(kSweepTime), world.target(), Detection(0));
  ASSERT_EQ(boards.candidates.size(), 2U) << boards.why;
  const double nearer = std::min(CentreError(boards.candidates[0], world.lidar_from_target()),
                                 CentreError(boards.candidates[1], world.lidar_from_target()));
  EXPECT_LT(nearer, 0.01);
}

TEST(BoardInCloud, HeldByAPersonItIsFound) {
  for (const int rings : {0, 32}) {
    simulate::Options options = Physics(rings, 5);
    options.clutter.holder = simulate::Holder::kPerson;
    const CloudWorld world(options, 2);
    const auto boards = FindBoards(world.Sweep(kSweepTime), world.target(), Detection(rings));
    ASSERT_FALSE(boards.candidates.empty()) << boards.why;
    EXPECT_LT(CentreError(boards.candidates[0], world.lidar_from_target()), 0.06);
  }
}

TEST(BoardInCloud, WhatIsFlushWithTheBoardLeavesTheRightPlaceAmongTheCandidates) {
  simulate::Options options = Physics(0, 6);
  options.clutter.holder = simulate::Holder::kEasel;
  for (int view = 0; view < 5; ++view) {
    const CloudWorld world(options, view);
    const auto boards = FindBoards(world.Sweep(kSweepTime), world.target(), Detection(0));
    double nearest = 1e9;
    for (const CloudEdges& c : boards.candidates) {
      nearest = std::min(nearest, CentreError(c, world.lidar_from_target()));
    }
    EXPECT_LT(nearest, 0.02) << view << ": " << boards.why;
  }
}

TEST(BoardInCloud, ABoardOfAnotherSizeIsNamedWithBothSizes) {
  const CloudWorld world(Physics(0, 7), 0);
  Target smaller = world.target();
  smaller.width_m = 0.85;
  smaller.height_m = 0.61;
  const auto boards = FindBoards(world.Sweep(kSweepTime), smaller, Detection(0));
  EXPECT_TRUE(boards.candidates.empty());
  EXPECT_THAT(boards.why, HasSubstr("the rig file says 0.61 x 0.85 m"));
  EXPECT_THAT(boards.why, HasSubstr("measured 0.9"));
  EXPECT_THAT(boards.why, HasSubstr(" x 1.2"));
}

// As some tools want it: nothing says where the beams beside the board went.
TEST(BoardInCloud, ABoardThatWasCutOutOfItsCloudIsNamed) {
  simulate::Options options = Physics(32);
  options.pose.max_roll_rad = 0;
  const CloudWorld world(options, 0);
  const Target& target = world.target();
  const Cloud whole = world.Sweep(kSweepTime);
  Cloud part = whole;
  for (Eigen::Vector3f& p : part.points) {
    const Eigen::Vector3d on = world.lidar_from_target().Inverse() * p.cast<double>();
    const bool is_on = std::abs(on.x()) < target.width_m / 2 &&
                       std::abs(on.y()) < target.height_m / 2 && std::abs(on.z()) < 0.1;
    if (!is_on) p.setConstant(std::numeric_limits<float>::quiet_NaN());
  }
  const auto boards = FindBoards(simulate::Unorganised(part, true), target, Detection(32));
  EXPECT_TRUE(boards.candidates.empty());
  EXPECT_THAT(boards.why, HasSubstr("cut out of a whole one"));
  Target larger = target;
  larger.width_m += 0.3;
  EXPECT_THAT(FindBoards(whole, larger, Detection(32)).why, Not(HasSubstr("cut out")));
}

TEST(BoardInCloud, EmptyCloudsAndCloudsOfNothingSaySo) {
  const CloudWorld world(Physics(0), 0);
  EXPECT_THAT(FindBoards(Cloud(), world.target()).why, HasSubstr("0 points"));
  Cloud cloud = world.Sweep(kSweepTime);
  for (Eigen::Vector3f& p : cloud.points) {
    p = Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
  }
  EXPECT_THAT(FindBoards(cloud, world.target()).why, HasSubstr("0 points"));
  cloud.organised = false;
  EXPECT_THAT(FindBoards(cloud, world.target()).why, HasSubstr("0 points"));
  Cloud heap;  // a thousand times the same point
  heap.organised = false;
  heap.lines = 1;
  heap.beams = 1000;
  heap.points.assign(1000, {2, 0, 0});
  EXPECT_TRUE(FindBoards(heap, world.target()).candidates.empty());
  for (std::size_t i = 0; i < 1000; ++i) heap.points[i] = {2, 0, 0.001F * static_cast<float>(i)};
  EXPECT_TRUE(FindBoards(heap, world.target()).candidates.empty());
}

TEST(BoardInCloud, NoCloudIsTooOdd) {
  const Target target = simulate::MakeTarget({});
  std::mt19937 random(5);
  const auto uniform = [&](double low, double high) {
    return static_cast<float>(std::uniform_real_distribution<double>(low, high)(random));
  };
  for (int trial = 0; trial < 60; ++trial) {
    Cloud cloud;
    const int n = 1 + static_cast<int>(random() % 5000);
    cloud.lines = 1;
    cloud.beams = n;
    cloud.organised = trial % 3 == 0;
    const double tiny = std::pow(10.0, uniform(-7, 1));
    for (int i = 0; i < n; ++i) {
      // Specks of dense points, strays all round, huge and broken values.
      Eigen::Vector3f p(2 + uniform(-tiny, tiny), uniform(-tiny, tiny), uniform(-tiny, tiny));
      if (random() % 50 == 0) p = {uniform(-9, 9), uniform(-9, 9), uniform(-9, 9)};
      if (random() % 500 == 0) p *= 1e30F;
      if (random() % 100 == 0) p.y() = std::numeric_limits<float>::infinity();
      if (random() % 100 == 0) p = Eigen::Vector3f::Zero();
      cloud.points.push_back(p);
    }
    if (trial % 2 == 0) {
      for (int i = 0; i < n; ++i) cloud.ring.push_back(static_cast<std::uint16_t>(random()));
    }
    EXPECT_TRUE(FindBoards(cloud, target).candidates.empty()) << trial;
  }
}

TEST(BoardInCloud, TheSameCloudGivesTheSameBits) {
  const CloudWorld world(Physics(32, 8), 0);
  const Cloud cloud = world.Sweep(kSweepTime);
  const auto a = FindBoards(cloud, world.target(), Detection(32));
  const auto b = FindBoards(cloud, world.target(), Detection(32));
  ASSERT_EQ(a.candidates.size(), b.candidates.size());
  ASSERT_FALSE(a.candidates.empty());
  EXPECT_EQ(a.candidates[0].boundary, b.candidates[0].boundary);
  EXPECT_EQ(a.candidates[0].pose->covariance, b.candidates[0].pose->covariance);
}

TEST(BoardInCloud, ANoisierLidarThanTheRigSaysIsNoHindrance) {
  for (const int rings : {0, 32}) {
    simulate::Options options = Physics(rings, 9);
    (rings == 0 ? options.scanner.range_sigma_m : options.spinning->range_sigma_m) = 0.03;
    const CloudWorld world(options, 0);
    const auto boards = FindBoards(world.Sweep(kSweepTime), world.target(), Detection(0));  // 10 mm
    ASSERT_FALSE(boards.candidates.empty()) << rings << ": " << boards.why;
    EXPECT_LT(CentreError(boards.candidates[0], world.lidar_from_target()), 0.06);
  }
}

// Mean distance of groups' points behind the board's front [m]: of dark ones and of bright ones.
struct Behind {
  double dark = 0, bright = 0;
};
Behind BehindOf(const CloudEdges& board) {
  double sums[2] = {0, 0};
  double counts[2] = {0, 0};
  for (const PointGroup& group : board.groups) {
    const int bright = group.log2_intensity > -2 ? 1 : 0;
    sums[bright] -= group.scatter.col(3).head<3>().dot(board.normal);
    counts[bright] += group.scatter(3, 3);
  }
  return {sums[0] / counts[0], sums[1] / counts[1]};
}

TEST(BoardInCloud, ItsPointsAreToldApartByRingAndBrightness) {
  for (const int rings : {0, 32}) {
    simulate::Options options = Physics(rings, 3);
    (rings == 0 ? options.scanner.dark_range_m : options.spinning->dark_range_m) = 0.015;
    const CloudWorld world(options, 0);
    Cloud cloud = world.Sweep(kSweepTime);
    const auto boards = FindBoards(cloud, world.target(), Detection(rings));
    ASSERT_FALSE(boards.candidates.empty()) << boards.why;
    const CloudEdges& board = boards.candidates[0];
    double points = 0;
    std::set<int> found;
    for (const PointGroup& group : board.groups) {
      found.insert(group.ring);
      points += group.scatter(3, 3);
    }
    EXPECT_NEAR(points, board.points, rings == 0 ? 0.05 * board.points : 1e-9) << rings;
    if (rings == 0) {
      EXPECT_EQ(found, std::set<int>{-1});
    } else {
      EXPECT_GE(found.size(), 3U);
      EXPECT_GE(*found.begin(), 0);
      EXPECT_LT(*found.rbegin(), rings);
    }
    const Behind behind = BehindOf(board);
    EXPECT_NEAR(behind.dark - behind.bright, 0.015, 0.006) << rings;
    EXPECT_NEAR(board.group_sigma_m, rings == 0 ? 0.01 : 0.02, 0.008) << rings;

    cloud.intensity.clear();
    const auto unlit = FindBoards(cloud, world.target(), Detection(rings));
    ASSERT_FALSE(unlit.candidates.empty()) << unlit.why;
    for (const PointGroup& group : unlit.candidates[0].groups) {
      EXPECT_EQ(group.log2_intensity, 0);
    }
  }
}

TEST(BoardInCloud, BadOptionsAreNamed) {
  BoardInCloudOptions options;
  options.edge.side_sigma_rad = 0;
  try {
    options.Check();
    FAIL() << "expected InputError";
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("edge.side_sigma_rad is 0"));
  }
}

}  // namespace
}  // namespace rgbdt
