// Drives by rays, whose truth is known: the simulator shares no code with the estimator.
#include "calib/odometry/odometry.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "calib/model/errors.h"
#include "tests/numbers.h"
#include "tests/study/drives.h"

namespace rgbdt {
namespace {

using study::Drive;
using study::DriveScene;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

// Half the columns: for what does not need to be exact.
simulate::SpinningOptions Lidar(int rings = 32, int share = 2) {
  simulate::SpinningOptions lidar = simulate::SpinningLidar(rings);
  lidar.azimuth_step_rad *= share;
  return lidar;
}

Drive Street(double speed_mps = 5, int share = 2, std::uint64_t seed = 4) {
  return {DriveScene::kStreet, seed, Lidar(32, share), study::StreetWay(seed, speed_mps)};
}

Drive Corridor(std::uint64_t seed) {
  return {DriveScene::kCorridor, seed, Lidar(), study::StreetWay(seed, 1, 0.2)};
}

// truth = estimate * Exp(this), in LIDAR axes, after sweeps 0 to `last`: since sweep 0.
Vector6d ErrorAfter(int last, Drive* drive, OdometryResult* result) {
  Odometry odometry;
  Rigid3 truth_from_world;
  for (int i = 0; i <= last; ++i) {
    *result = odometry.Add(drive->Sweep(i));
    if (i == 0) truth_from_world = drive->At(result->middle_utime);
    EXPECT_EQ(result->converged, i > 0) << i << ' ' << result->reason;
  }
  return Log((truth_from_world * result->world_from_lidar).Inverse() * drive->At(result->utime));
}

// Of several drives: one alone is a matter of luck.
constexpr std::uint64_t kDrives = 8;

TEST(Odometry, FollowsADriveWhoseSweepsAreSkewedByTheMotion) {
  Vector6d squares = Vector6d::Zero();
  for (std::uint64_t seed = 1; seed <= kDrives; ++seed) {
    Drive drive = Street(8, 1, seed);
    OdometryResult result;
    squares += ErrorAfter(30, &drive, &result).cwiseAbs2() / kDrives;
    const double way = (drive.At(result.utime).translation - drive.At(0).translation).x();
    EXPECT_GT(way, 15);
    EXPECT_THAT(result.degenerate, IsEmpty());
    EXPECT_NEAR(result.velocity[3], 8, 2);
    EXPECT_GT(result.matched, 1000U);
    EXPECT_LT(std::sqrt(result.covariance.diagonal().maxCoeff()), 0.01);
  }
  EXPECT_LT(std::sqrt(squares.tail<3>().sum()), 0.03);
  EXPECT_LT(std::sqrt(squares.head<3>().sum()), 0.1 * kDegree);
}

TEST(Odometry, AFullMapKeepsWhatIsNear) {
  OdometryOptions options;
  options.max_voxels = 10000;  // a sweep brings that many
  Odometry odometry(options);
  Drive drive = Street(8, 2);
  OdometryResult result;
  Rigid3 truth_from_world;
  for (int i = 0; i <= 30; ++i) {
    result = odometry.Add(drive.Sweep(i));
    if (i == 0) truth_from_world = drive.At(result.middle_utime);
    ASSERT_EQ(result.converged, i > 0) << i << ' ' << result.reason;
  }
  const Vector6d off =
      Log((truth_from_world * result.world_from_lidar).Inverse() * drive.At(result.utime));
  EXPECT_LT(off.tail<3>().norm(), 0.2);
}

TEST(Odometry, SixteenRingsInARoom) {
  Vector6d squares = Vector6d::Zero();
  for (std::uint64_t seed = 1; seed <= kDrives; ++seed) {
    Drive drive(DriveScene::kRoom, seed, Lidar(16, 1), study::RoomWay(seed, 0.8));
    OdometryResult result;
    squares += ErrorAfter(20, &drive, &result).cwiseAbs2() / kDrives;
  }
  EXPECT_LT(std::sqrt(squares.tail<3>().sum()), 0.03);
  EXPECT_LT(std::sqrt(squares.head<3>().sum()), 0.5 * kDegree);
}

TEST(Odometry, ACorridorDoesNotTellTheWayAlongIt) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    Drive drive = Corridor(seed);
    Odometry odometry;
    for (int i = 0; i < 8; ++i) {
      const OdometryResult result = odometry.Add(drive.Sweep(i));
      if (i == 0) continue;
      ASSERT_TRUE(result.converged) << result.reason;
      EXPECT_THAT(result.degenerate, ElementsAre("a move along the LIDAR's x (forward)")) << i;
      EXPECT_GT(result.covariance(3, 3), 100 * result.covariance(5, 5));
    }
  }
}

TEST(Odometry, APlainTellsHeightRollAndPitchOnly) {
  Drive drive(DriveScene::kPlain, 1, Lidar(), study::StreetWay(1, 5));
  OdometryResult result;
  const Vector6d off = ErrorAfter(8, &drive, &result);
  EXPECT_THAT(result.degenerate, UnorderedElementsAre("a move along the LIDAR's x (forward)",
                                                      "a move along the LIDAR's y (left)",
                                                      "a turn about the LIDAR's z (yaw)"));
  EXPECT_LT(off.head<2>().norm(), 0.2 * kDegree);
}

// A way that was known goes on evenly where nothing tells it.
TEST(Odometry, GoesOnAsBeforeWhereNothingTells) {
  Odometry odometry;
  Drive street = Street();
  OdometryResult before;
  for (int i = 0; i < 8; ++i) before = odometry.Add(street.Sweep(i));
  Drive plain(DriveScene::kPlain, 4, Lidar(), study::StreetWay(4, 5));
  OdometryResult after;
  for (int i = 8; i < 11; ++i) after = odometry.Add(plain.Sweep(i));
  const double way =
      (after.world_from_middle.translation - before.world_from_middle.translation).head<2>().norm();
  EXPECT_NEAR(way, 0.3 * before.velocity.tail<3>().norm(), 0.1);
  EXPECT_GT(after.covariance(3, 3), 4 * before.covariance(3, 3));
}

TEST(Odometry, TheSameSweepsGiveTheSamePoses) {
  Odometry one, two;
  Drive drive = Street();
  for (int i = 0; i < 5; ++i) {
    const Cloud sweep = drive.Sweep(i);
    const OdometryResult a = one.Add(sweep), b = two.Add(sweep);
    EXPECT_EQ(a.world_from_lidar.translation, b.world_from_lidar.translation);
    EXPECT_EQ(a.world_from_lidar.rotation.coeffs(), b.world_from_lidar.rotation.coeffs());
    EXPECT_EQ(a.covariance, b.covariance);
  }
}

TEST(Odometry, ASweepOfNothingIsSaidAndTheNextOneGoesOn) {
  Odometry odometry;
  Drive drive = Street();
  for (int i = 0; i < 4; ++i) odometry.Add(drive.Sweep(i));
  Cloud empty;
  empty.sweep_utime = drive.Sweep(4).sweep_utime;
  OdometryResult result = odometry.Add(empty);
  EXPECT_FALSE(result.converged);
  EXPECT_THAT(result.reason, HasSubstr("the sweep has 0 points of use; expected 300 or more"));
  Cloud blind = drive.Sweep(5);
  for (Eigen::Vector3f& p : blind.points) {
    p.setConstant(std::numeric_limits<float>::quiet_NaN());
  }
  result = odometry.Add(blind);
  EXPECT_FALSE(result.converged);
  EXPECT_THAT(result.reason, HasSubstr("0 points of use"));
  result = odometry.Add(drive.Sweep(6));
  EXPECT_TRUE(result.converged) << result.reason;
  EXPECT_FALSE(result.restarted);
}

TEST(Odometry, NothingButNothing) {
  Odometry odometry;
  for (int i = 0; i < 10; ++i) {
    Cloud empty;
    empty.sweep_utime = 1000 + i;
    const OdometryResult result = odometry.Add(empty);
    EXPECT_FALSE(result.converged);
    EXPECT_TRUE(result.world_from_lidar.translation.allFinite());
  }
}

// Carried sixty metres on between two sweeps: said, and after some sweeps the map is begun anew.
TEST(Odometry, AJumpIsNotTakenForAWay) {
  Odometry odometry;
  Drive drive = Street();
  OdometryResult before;
  for (int i = 0; i < 5; ++i) before = odometry.Add(drive.Sweep(i));
  int refused = 0, restarts = 0;
  OdometryResult result;
  for (int i = 0; i < 12; ++i) {
    Cloud elsewhere = drive.Sweep(130 + i);
    const Utime shift = drive.Sweep(5 + i).sweep_utime - elsewhere.sweep_utime;
    elsewhere.sweep_utime += shift;
    for (Utime& utime : elsewhere.utime) utime += shift;
    result = odometry.Add(elsewhere);
    if (!result.converged) ++refused;
    if (result.restarted) ++restarts;
    EXPECT_LT((result.world_from_lidar.translation - before.world_from_lidar.translation).norm(),
              1 + 0.1 * (i + 1) * 8);
  }
  EXPECT_GE(refused, 2);
  EXPECT_EQ(restarts, 1);
  EXPECT_TRUE(result.converged) << result.reason;
}

TEST(Odometry, AfterALongGapTheMapIsBegunAnew) {
  Odometry odometry;
  Drive drive = Street();
  for (int i = 0; i < 4; ++i) odometry.Add(drive.Sweep(i));
  const OdometryResult after = odometry.Add(drive.Sweep(24));
  EXPECT_TRUE(after.restarted);
  EXPECT_FALSE(after.converged);
  EXPECT_THAT(after.reason, HasSubstr("begins with this sweep"));
  EXPECT_TRUE(odometry.Add(drive.Sweep(25)).converged);
}

TEST(Odometry, AClockThatIsSetBackAtAnEmptySweepIsFollowed) {
  Odometry odometry;
  Drive drive = Street();
  for (int i = 0; i < 4; ++i) odometry.Add(drive.Sweep(i));
  const auto earlier = [](Cloud cloud) {
    constexpr Utime kHour = 3600 * kMicrosecondsPerSecond;
    cloud.sweep_utime -= kHour;
    for (Utime& utime : cloud.utime) utime -= kHour;
    return cloud;
  };
  Cloud empty;
  empty.sweep_utime = drive.Sweep(4).sweep_utime;
  EXPECT_FALSE(odometry.Add(earlier(empty)).converged);
  const OdometryResult after = odometry.Add(earlier(drive.Sweep(5)));
  EXPECT_TRUE(after.restarted);
  EXPECT_TRUE(odometry.Add(earlier(drive.Sweep(6))).converged);
}

TEST(Odometry, WhatCannotBeTakenIsAsIfItHadNeverCome) {
  Odometry one, two;
  Drive drive = Street();
  std::vector<Cloud> sweeps;
  for (int i = 0; i < 5; ++i) sweeps.push_back(drive.Sweep(i));
  Cloud uneven = sweeps[3];
  uneven.utime.pop_back();
  Cloud slow = sweeps[3];
  for (std::size_t i = 0; i < slow.size(); ++i) {
    slow.utime[i] = slow.sweep_utime + 30 * (slow.utime[i] - slow.sweep_utime);
  }
  Cloud stray = sweeps[3];
  for (Utime& utime : stray.utime) utime = std::numeric_limits<Utime>::min();
  for (int i = 0; i < 5; ++i) {
    const OdometryResult a = one.Add(sweeps[static_cast<std::size_t>(i)]);
    const OdometryResult b = two.Add(sweeps[static_cast<std::size_t>(i)]);
    EXPECT_EQ(a.world_from_lidar.translation, b.world_from_lidar.translation);
    if (i != 2) continue;
    EXPECT_THAT([&] { one.Add(uneven); },
                ::testing::ThrowsMessage<InputError>(HasSubstr("expected a time for each point")));
    EXPECT_THAT([&] { one.Add(slow); },
                ::testing::ThrowsMessage<InputError>(HasSubstr(
                    "a turned scanner's by how long it lasts, the ones before are a spinning")));
    EXPECT_THAT([&] { one.Add(stray); },
                ::testing::ThrowsMessage<InputError>(HasSubstr("expected one within 120 s")));
    EXPECT_THAT([&] { one.Add(sweeps[1]); },
                ::testing::ThrowsMessage<InputError>(HasSubstr("is not newer than")));
  }
}

TEST(Odometry, ATurnedScannersRigStandsForEachSweepAndGoesOnInBetween) {
  const study::Stops stops(5, study::QuickScanner(), 1.2);
  Odometry odometry;
  for (int i = 0; i < 6; ++i) {
    const Cloud sweep = stops.Sweep(i);
    const OdometryResult result = odometry.Add(sweep);
    EXPECT_TRUE(result.converged) << i << ' ' << result.reason;
    EXPECT_TRUE(result.standing);
    EXPECT_EQ(result.restarted, false);
    EXPECT_GT(ToSeconds(result.utime - result.first_utime), 2);
    EXPECT_EQ(result.velocity, Vector6d::Zero());
    const Vector6d off = Log((stops.At(0) * result.world_from_lidar).Inverse() * stops.At(i));
    EXPECT_LT(off.tail<3>().norm(), 0.01) << i;
    EXPECT_LT(off.head<3>().norm(), 0.2 * kDegree) << i;
    EXPECT_LT(std::sqrt(result.covariance.diagonal().maxCoeff()), 0.01);
  }
}

TEST(Odometry, ATurnedScannersSweepFromElsewhereIsSaidAndTheNextOneGoesOn) {
  const study::Stops stops(5, study::QuickScanner(), 1.2), elsewhere(6, study::QuickScanner(), 1.2);
  Odometry odometry;
  odometry.Add(stops.Sweep(0));
  odometry.Add(stops.Sweep(1));
  const OdometryResult lost = odometry.Add(elsewhere.Sweep(2));
  EXPECT_FALSE(lost.converged);
  EXPECT_THAT(lost.reason, HasSubstr("is to stand while it sweeps"));
  const OdometryResult back = odometry.Add(stops.Sweep(3));
  EXPECT_TRUE(back.converged) << back.reason;
  EXPECT_LT(
      (stops.At(0) * back.world_from_lidar).translation.norm() - stops.At(3).translation.norm(),
      0.01);
}

TEST(Odometry, StopsAreFoundWhateverTheyWereSweptWith) {
  const study::Stops stops(5, study::QuickScanner(), 1.2), elsewhere(6, study::QuickScanner(), 1.2);
  std::vector<Cloud> sweeps;
  for (const int number : {0, 1, 2, 3}) sweeps.push_back(stops.Sweep(number));
  sweeps.push_back(elsewhere.Sweep(0));
  sweeps.emplace_back();  // no point
  sweeps.push_back(stops.Sweep(4));
  std::vector<const Cloud*> pointers;
  for (Cloud& sweep : sweeps) {
    sweep.utime.clear();  // as a view of a spinning LIDAR's has none
    sweep.sweep_utime = 0;
    pointers.push_back(&sweep);
  }
  const std::vector<StopPlace> places = Odometry::FindStops(pointers);
  ASSERT_EQ(places.size(), 7U);
  for (const auto& [i, number] :
       std::vector<std::pair<std::size_t, int>>{{1, 1}, {2, 2}, {3, 3}, {6, 4}}) {
    EXPECT_EQ(places[i].world, places[0].world) << number;
    const Rigid3 off = (stops.At(0) * places[i].world_from_lidar).Inverse() * stops.At(number);
    EXPECT_LT(off.translation.norm(), 0.01) << number;
    EXPECT_LT(RotationDistance(off, {}), 0.2 * kDegree) << number;
  }
  EXPECT_NE(places[4].world, places[0].world);
  EXPECT_NE(places[5].world, places[0].world);
  EXPECT_NE(places[5].world, places[4].world);
}

TEST(Odometry, AStopThatNoneOfTheOthersFitsIsLeftBehind) {
  const study::Stops stops(5, study::QuickScanner(), 1.2);
  const std::vector<Cloud> sweeps = {Street().Sweep(0), stops.Sweep(0), stops.Sweep(1)};
  const std::vector<StopPlace> places = Odometry::FindStops({&sweeps[0], &sweeps[1], &sweeps[2]});
  EXPECT_NE(places[0].world, places[1].world);
  EXPECT_EQ(places[1].world, places[2].world);
}

TEST(Odometry, ATurnedScannersRigDrivesWhileItSweeps) {
  study::TurningDrive drive(5, study::QuickScanner(), 0.5);
  Odometry odometry;
  Utime until = 0;
  for (int i = 0; i < 5; ++i) {
    const OdometryResult result = odometry.Add(drive.Sweep(i));
    ASSERT_TRUE(result.converged) << i << ' ' << result.reason;
    EXPECT_EQ(result.standing, i == 0);
    ASSERT_EQ(result.way.empty(), i == 0);
    if (i == 0) continue;
    EXPECT_GT(ToSeconds(result.utime - result.first_utime), 2);
    EXPECT_EQ(result.way.front().utime, result.first_utime);
    EXPECT_EQ(result.way.back().utime, result.utime);
    if (i > 1) {
      EXPECT_EQ(result.first_utime, until) << "on from where the way ended";
    }
    until = result.utime;
    const Rigid3 start = drive.At(0);
    Utime before = 0;
    for (const PoseAtTime& pose : result.way) {
      const Vector6d off = Log((start * pose.world_from_lidar).Inverse() * drive.At(pose.utime));
      EXPECT_LT(off.tail<3>().norm(), 0.03) << i;
      EXPECT_LT(off.head<3>().norm(), 1 * kDegree) << i;
      EXPECT_GT(pose.utime, before);
      before = pose.utime;
    }
    const Vector6d off =
        Log((start * result.world_from_middle).Inverse() * drive.At(result.middle_utime));
    EXPECT_LT(off.tail<3>().norm(), 0.03) << i;
    EXPECT_GT(result.velocity.tail<3>().norm(), i == 1 ? 0.1 : 0.4);
    EXPECT_LT(std::sqrt(result.covariance.diagonal().maxCoeff()), 0.1);
  }
}

// What was said to stand was up to 0.3 m off, with a sigma of some millimetres.
TEST(Odometry, ATurnedScannersRigThatCannotBeFollowedIsSaidToBeLost) {
  study::TurningDrive drive(5, study::QuickScanner(), 2.5);
  Odometry odometry;
  odometry.Add(drive.Sweep(0));
  for (int i = 1; i < 4; ++i) {
    const OdometryResult result = odometry.Add(drive.Sweep(i));
    EXPECT_FALSE(result.converged) << i;
    EXPECT_THAT(result.reason, HasSubstr("to drive slowly"));
    EXPECT_TRUE(result.way.empty());
  }
}

TEST(Odometry, ATurnedScannersRigStandsAgainAfterADrive) {
  study::TurningDrive drive(6, study::QuickScanner(), 0.25);
  Odometry odometry;
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(odometry.Add(drive.Sweep(i)).converged) << i;
  // It stands for this one.
  const Cloud sweep = drive.StandingSweep(3);
  const OdometryResult stood = odometry.Add(sweep);
  ASSERT_TRUE(stood.converged) << stood.reason;
  EXPECT_TRUE(stood.standing);
  const Rigid3 truth = drive.At(sweep.sweep_utime);
  const Vector6d off = Log((drive.At(0) * stood.world_from_lidar).Inverse() * truth);
  EXPECT_LT(off.tail<3>().norm(), 0.02);
}

// The last lines of a sweep that began before the odometry did.
TEST(Odometry, APartOfATurnedScannersSweepDoesNotDecideWhatTheLidarIs) {
  const study::Stops stops(5, study::QuickScanner(), 0.5);
  Cloud part = stops.Sweep(0);
  const std::size_t keep = part.size() / 8;
  for (std::size_t i = keep; i < part.size(); ++i) part.points[i].setConstant(NAN);
  Odometry odometry;
  odometry.Add(part);
  EXPECT_TRUE(odometry.Add(stops.Sweep(1)).converged);
  const OdometryResult result = odometry.Add(stops.Sweep(2));
  EXPECT_TRUE(result.converged);
  EXPECT_TRUE(result.standing);
}

// What is seen, and the same turned by half a turn.
Cloud Twice(Cloud sweep) {
  const Eigen::Quaternionf turn(0, 0, 0, 1);
  const std::size_t size = sweep.size();
  sweep.lines *= 2;
  for (std::size_t i = 0; i < size; ++i) {
    sweep.points.push_back(turn * sweep.points[i]);
    sweep.directions.push_back(turn * sweep.directions[i]);
    sweep.utime.push_back(sweep.utime[i]);
  }
  return sweep;
}

TEST(Odometry, AStopThatFitsTwoPlacesIsNotTakenForOneOfThem) {
  const study::Stops stops(5, study::QuickScanner(), 0);
  Odometry odometry;
  odometry.Add(Twice(stops.Sweep(0)));
  const OdometryResult result = odometry.Add(Twice(stops.Sweep(1)));
  EXPECT_FALSE(result.converged);
  EXPECT_THAT(result.reason, HasSubstr("fits two places about as well, 0.0 m and 180 degrees"));
}

TEST(Odometry, OptionsNameTheFieldAndItsValue) {
  OdometryOptions options;
  options.selected = 3;
  EXPECT_THAT([&] { Odometry{options}; },
              ::testing::ThrowsMessage<InputError>(HasSubstr("selected is 3")));
  options = {};
  options.min_range_m = 0;  // where drivers put beams that returned nothing
  EXPECT_THAT([&] { options.Check(); },
              ::testing::ThrowsMessage<InputError>(HasSubstr("min_range_m")));
  options = {};
  options.max_range_m = std::nan("");
  EXPECT_THAT([&] { options.Check(); },
              ::testing::ThrowsMessage<InputError>(HasSubstr("max_range_m")));
}

}  // namespace
}  // namespace rgbdt
