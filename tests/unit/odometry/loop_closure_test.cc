// A street there and back by rays, with a known drift put on the true way.
#include "calib/odometry/loop_closure.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "calib/model/errors.h"
#include "tests/study/drives.h"

namespace rgbdt {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

constexpr double kStep = 2;  // [m] between sweeps, at each of which the LIDAR stands
constexpr int kThere = 25;   // steps; then back again, the other way about

Rigid3 OutAndBack(int i) {
  const bool back = i > kThere;
  Rigid3 pose = RotationAbout(Eigen::Vector3d::UnitZ(), back ? M_PI : 0);
  pose.translation = {kStep * (back ? 2 * kThere + 0.4 - i : i), back ? -0.5 : 0.5, 0};
  return pose;
}

study::Drive Street(std::uint64_t seed) {
  simulate::SpinningOptions lidar = simulate::SpinningLidar(32);
  lidar.azimuth_step_rad *= 4;
  return {study::DriveScene::kStreet, seed, lidar, [](double seconds) {
            return OutAndBack(static_cast<int>(std::floor(seconds * 10 + 1e-6)));
          }};
}

// What odometry would say.
OdometryResult Said(const Rigid3& pose, Utime middle) {
  OdometryResult said;
  said.middle_utime = said.utime = middle;
  said.world_from_middle = said.world_from_lidar = pose;
  said.converged = true;
  Vector6d sigma;
  sigma << Eigen::Vector3d::Constant(2e-4), Eigen::Vector3d::Constant(0.005);
  said.covariance = sigma.cwiseAbs2().asDiagonal();
  return said;
}

struct DriftedWay {
  ClosedWay closed;
  std::vector<Rigid3> truth;
};

enum class Cameras { kNone, kSee, kSeeOthersOnTheWayBack };

// What cameras would make of a sweep: a beam's return is the brightness; `other`: of another place.
RgbdtCloud Coloured(const Cloud& sweep, const Rigid3& pose, bool other) {
  RgbdtCloud fused;
  fused.whole_sweep = true;
  fused.sweep_utime = sweep.sweep_utime;
  fused.frame_utime = sweep.utime.front();
  fused.map_from_lidar = pose;
  for (std::size_t i = 0; i < sweep.size(); ++i) {
    if (!(sweep.points[i].norm() < 100)) continue;
    // Stripes a metre wide, which lie where they lie by luck.
    const Eigen::Vector3d at = pose * sweep.points[i].cast<double>();
    const double stripes = std::sin(2.1 * at.x() + 1.3 * at.y() + (other ? 5 * at.x() : 0));
    const double bright = (0.3 + 0.7 * sweep.intensity[i]) * (1.2 + stripes);
    const auto grey = static_cast<std::uint8_t>(1 + std::min(250.0, 100 * bright));
    fused.points.push_back(sweep.points[i]);
    fused.rgb.push_back({grey, grey, grey});
    fused.temperature_k.push_back(NAN);
  }
  return fused;
}

// `back`: the street of the way back.
DriftedWay DriveBackBy(std::uint64_t there, std::uint64_t back, const Vector6d& drift,
                       Cameras cameras = Cameras::kNone) {
  study::Drive first = Street(there), second = Street(back);
  Keyframes keyframes;
  LoopColours colours;
  DriftedWay drifted;
  Rigid3 found;
  for (int i = 0; i < 2 * kThere; ++i) {
    drifted.truth.push_back(OutAndBack(i));
    if (i == 0) {
      found = drifted.truth[0];
    } else {
      const Rigid3 step = drifted.truth[static_cast<std::size_t>(i) - 1].Inverse() *
                          drifted.truth[static_cast<std::size_t>(i)];
      found = found * step * Exp(drift);
    }
    const Cloud sweep = (i > kThere ? second : first).Sweep(i);
    keyframes.Add(sweep, Said(found, (sweep.utime.front() + sweep.utime.back()) / 2));
    if (cameras == Cameras::kNone) continue;
    // Stripes stand still in the world: painted where the LIDAR truly is, told where it seems to
    // be.
    RgbdtCloud fused = Coloured(sweep, drifted.truth.back(),
                                i > kThere && cameras == Cameras::kSeeOthersOnTheWayBack);
    fused.map_from_lidar = found;
    colours.Add(fused);
  }
  drifted.closed = CloseLoops(keyframes, colours);
  return drifted;
}

// What a way there and back tells: a stretch of it would cancel itself.
Vector6d Drift() {
  Vector6d drift;
  drift << 0, 0, 2e-4, 0, 0, 0.003;
  return drift;
}

double Farthest(const std::vector<Rigid3>& found, const std::vector<Rigid3>& truth) {
  double most = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    most = std::max(most, (found[i].translation - truth[i].translation).norm());
  }
  return most;
}

TEST(LoopClosure, TheWayBackOtherWayAboutTakesTheDriftOut) {
  const DriftedWay drifted = DriveBackBy(4, 4, Drift());
  const ClosedWay& closed = drifted.closed;
  ASSERT_THAT(closed.before, SizeIs(drifted.truth.size()));
  ASSERT_GT(closed.loops.size(), 5U);
  const double before = Farthest(closed.before, drifted.truth);
  EXPECT_GT(before, 0.15);
  EXPECT_LT(Farthest(closed.after, drifted.truth), 0.35 * before);
  EXPECT_NEAR(closed.most_moved_m, before, 0.3 * before);
  EXPECT_NEAR(closed.end_moved_m,
              (closed.after.back().translation - closed.before.back().translation).norm(), 1e-12);
  for (const ClosedLoop& loop : closed.loops) {
    const auto at = [&](Utime utime) {
      const auto found = std::find(closed.utimes.begin(), closed.utimes.end(), utime);
      return drifted.truth.at(static_cast<std::size_t>(found - closed.utimes.begin()));
    };
    const Vector6d off =
        Log(loop.old_from_new.Inverse() * (at(loop.old_utime).Inverse() * at(loop.new_utime)));
    EXPECT_LT(off.tail<3>().norm(), 0.05);
    EXPECT_LT(off.head<3>().norm(), 0.005);
  }
  // The end of the way lies on its beginning again.
  const Rigid3 step = closed.after.front().Inverse() * closed.after.back();
  const Rigid3 true_step = drifted.truth.front().Inverse() * drifted.truth.back();
  EXPECT_LT((step.translation - true_step.translation).norm(), 0.05);
}

TEST(LoopClosure, ColoursThatAgreeChangeNothing) {
  const ClosedWay without = DriveBackBy(4, 4, Drift()).closed;
  const ClosedWay with = DriveBackBy(4, 4, Drift(), Cameras::kSee).closed;
  ASSERT_THAT(with.loops, SizeIs(without.loops.size()));
  std::size_t agree = 0;
  for (const ClosedLoop& loop : with.loops) {
    EXPECT_GT(loop.colours.cells, 500U);
    EXPECT_GT(loop.colours.correlation, 0.4);
    EXPECT_LT(loop.sigma_factor, 4);
    if (loop.sigma_factor == 1) ++agree;
  }
  EXPECT_GT(agree, with.loops.size() / 2);
  EXPECT_NEAR(with.end_moved_m, without.end_moved_m, 0.05 * without.end_moved_m);
  for (const ClosedLoop& loop : without.loops) {
    EXPECT_EQ(loop.colours.cells, 0U);
    EXPECT_EQ(loop.sigma_factor, 1);
  }
}

// To the LIDAR it is the same street, to a camera another one.
TEST(LoopClosure, WhereCamerasSeeAnotherPlaceALoopHardlyBendsTheWay) {
  const ClosedWay without = DriveBackBy(4, 4, Drift()).closed;
  const ClosedWay with = DriveBackBy(4, 4, Drift(), Cameras::kSeeOthersOnTheWayBack).closed;
  ASSERT_THAT(with.loops, Not(IsEmpty()));
  for (const ClosedLoop& loop : with.loops) {
    EXPECT_GT(loop.colours.cells, 500U);
    EXPECT_LT(loop.colours.correlation, 0.3);
    EXPECT_GT(loop.sigma_factor, 8);
  }
  EXPECT_LT(with.most_moved_m, 0.3 * without.most_moved_m);
}

TEST(LoopClosure, AnotherStreetClosesNoLoop) {
  const DriftedWay drifted = DriveBackBy(4, 5, Drift());
  EXPECT_THAT(drifted.closed.loops, IsEmpty());
  EXPECT_EQ(drifted.closed.most_moved_m, 0);
}

// The same street again, where odometry says it is 40 m away and cannot be off by that much.
TEST(LoopClosure, APlaceThatOnlyLooksTheSameIsRefused) {
  study::Drive street = Street(4);
  Keyframes keyframes;
  for (int i = 0; i < 12; ++i) {
    const Cloud sweep = street.Sweep(i % 6);
    Cloud later = sweep;
    later.sweep_utime += i * kMicrosecondsPerSecond;
    for (Utime& utime : later.utime) utime += i * kMicrosecondsPerSecond;
    Rigid3 said = OutAndBack(i % 6);
    if (i >= 6) said.translation.x() += 40;
    keyframes.Add(later, Said(said, (later.utime.front() + later.utime.back()) / 2));
  }
  const ClosedWay closed = CloseLoops(keyframes);
  EXPECT_THAT(closed.loops, IsEmpty());
  EXPECT_GT(closed.against_odometry, 0U);
  EXPECT_EQ(closed.most_moved_m, 0);
}

// Half the round later a block of twins looks the same, stone by stone.
TEST(LoopClosure, TwoPlacesThatLookTheSameAreNotJoined) {
  simulate::SpinningOptions lidar = simulate::SpinningLidar(32);
  lidar.azimuth_step_rad *= 4;
  constexpr double kApart = 4;  // [m]
  const study::Way way = study::BlockWay(1, 1);
  const auto at = [&](int i) { return way(kApart * i); };
  study::Drive drive(study::DriveScene::kTwins, 1, lidar, [&](double seconds) {
    return at(static_cast<int>(std::floor(seconds * 10 + 1e-6)));
  });
  Keyframes keyframes;
  for (int i = 0; kApart * i < 0.75 * study::BlockRound(); ++i) {
    const Cloud sweep = drive.Sweep(i);
    keyframes.Add(sweep, Said(at(i), (sweep.utime.front() + sweep.utime.back()) / 2));
  }
  const ClosedWay closed = CloseLoops(keyframes);
  EXPECT_THAT(closed.loops, IsEmpty());
  EXPECT_GT(closed.against_odometry, 10U);
  EXPECT_EQ(closed.most_moved_m, 0);
}

TEST(LoopClosure, MemoryIsBoundedByForgettingEverySecondKeyframe) {
  LoopClosureOptions options;
  options.max_keyframes = 10;
  Keyframes keyframes(options);
  for (int i = 0; i < 100; ++i) {
    Cloud sweep;
    sweep.sweep_utime = i * kMicrosecondsPerSecond;
    for (int k = 0; k < 200; ++k) {
      const double angle = 0.1 * k;
      sweep.points.emplace_back(10 * std::cos(angle), 10 * std::sin(angle), 0.01 * k);
    }
    Rigid3 pose;
    pose.translation.x() = 2.01 * i;
    keyframes.Add(sweep, Said(pose, sweep.sweep_utime));
    EXPECT_LE(keyframes.size(), 11U);
  }
  const ClosedWay closed = CloseLoops(keyframes);
  ASSERT_THAT(closed.before, SizeIs(keyframes.size()));
  EXPECT_EQ(closed.utimes.front(), 0);
  EXPECT_GT(closed.utimes.back(), 80 * kMicrosecondsPerSecond);
  for (std::size_t i = 0; i < closed.before.size(); ++i) {
    EXPECT_DOUBLE_EQ(closed.before[i].translation.x(), 2.01 * ToSeconds(closed.utimes[i]));
  }
}

TEST(LoopClosure, PosesBetweenKeyframesMoveAsThese) {
  ClosedWay way;
  way.loops.resize(1);
  way.utimes = {0, 1000000};
  way.before = {Rigid3{}, Rigid3{Eigen::Quaterniond::Identity(), {2, 0, 0}}};
  way.after = {Rigid3{}, Rigid3{Eigen::Quaterniond::Identity(), {2, 0.2, 0}}};
  const auto at = [&](Utime utime, double x) {
    return way.Corrected(utime, {Eigen::Quaterniond::Identity(), {x, 1, 0}}).translation;
  };
  EXPECT_NEAR((at(500000, 1) - Eigen::Vector3d(1, 1.1, 0)).norm(), 0, 1e-12);
  EXPECT_NEAR((at(-5, 1) - Eigen::Vector3d(1, 1, 0)).norm(), 0, 1e-12);
  EXPECT_NEAR((at(2000000, 4) - Eigen::Vector3d(4, 1.2, 0)).norm(), 0, 1e-12);
  EXPECT_NEAR((ClosedWay{}.Corrected(3, Rigid3{}).translation).norm(), 0, 1e-12);
}

TEST(LoopClosure, AnOptionThatIsOffIsNamed) {
  LoopClosureOptions options;
  options.keyframe_m = 0;
  try {
    const Keyframes keyframes(options);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(std::string(e.what()), HasSubstr("keyframe_m is 0"));
  }
}

}  // namespace
}  // namespace rgbdt
