// A mount that moved in the middle of a session: named, with the views between which it did.
#include "calib/solve/internal/mount_moved.h"

#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "calib/solve/by_boards.h"
#include "tests/unit/solve/joint_reports.h"

namespace rgbdt {
namespace {

using testing::AllOf;
using testing::HasSubstr;

SolveWorldOptions Drawn(std::uint32_t seed, int views) {
  SolveWorldOptions options = Views(views);
  options.seed = seed;
  options.draw_nuisances = true;
  return options;
}

// Both cameras moved against the LIDAR before the last views.
SolveWorld MovedAfter(int before, int behind, std::uint32_t seed) {
  SolveWorld world(Drawn(seed, before));
  world.MoveCameras(0.3 * M_PI / 180, 0.01);
  for (int i = 0; i < behind; ++i) world.AddView(world.AnyBoard());
  return world;
}

const Cause* MountIn(const CameraReport& camera) {
  for (const Cause& cause : camera.causes) {
    if (cause.name == "mount") return &cause;
  }
  return nullptr;
}

TEST(MountMoved, IsNamedFirstWithTheViewsBetweenWhichItDid) {
  for (std::uint32_t seed = 1; seed <= 4; ++seed) {
    const SolveWorld world = MovedAfter(6, 5, seed);
    const Report report = Calibrate(world.rig, world.detections);
    for (const CameraReport& camera : report.cameras) {
      ASSERT_FALSE(camera.causes.empty());
      const Cause& cause = camera.causes.front();
      EXPECT_EQ(cause.name, "mount") << seed;
      EXPECT_THAT(cause.words, AllOf(HasSubstr(camera.calibration.camera + " and the LIDAR moved"),
                                     HasSubstr("between views 0006 and 0007")));
      EXPECT_GT(cause.Sigmas(), 5);
    }
  }
}

// The solve takes them for two views that contradict the rest.
TEST(MountMoved, IsNamedWhereItDidBeforeTheLastTwoViews) {
  const SolveWorld world = MovedAfter(8, 2, 3);
  const CameraReport camera = Calibrate(world.rig, world.detections).cameras[0];
  const Cause* cause = MountIn(camera);
  ASSERT_NE(cause, nullptr);
  EXPECT_THAT(cause->words, HasSubstr("between views 0008 and 0009"));
}

TEST(MountMoved, ViewsAreInTheOrderOfTheirNumbers) {
  SolveWorld world = MovedAfter(6, 5, 2);
  for (std::size_t v = 0; v < world.detections.size(); ++v) {
    world.detections[v].view = "pose" + std::to_string(v + 4);
    for (ImageDetection& image : world.detections[v].images) image.utime = 0;
  }
  const CameraReport camera = Calibrate(world.rig, world.detections).cameras[0];
  const Cause* cause = MountIn(camera);
  ASSERT_NE(cause, nullptr);
  EXPECT_THAT(cause->words, HasSubstr("between views pose9 and pose10"));
}

TEST(MountMoved, IsNoAlarmWhereNothingMoved) {
  for (std::uint32_t seed = 1; seed <= 30; ++seed) {
    const SolveWorld world(Drawn(seed, 9));
    for (const CameraReport& camera : Calibrate(world.rig, world.detections).cameras) {
      EXPECT_EQ(MountIn(camera), nullptr) << seed;
    }
  }
}

// Asked whether it moved at a place that was given: chance makes the poses differ by no more than
// they state.
TEST(MountMoved, IsNotNamedByChanceWhereverItIsLookedFor) {
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const SolveWorld world(Drawn(seed, 9));
    std::vector<CameraViews> cameras;
    for (const CameraSpec& camera : world.rig.cameras) {
      cameras.push_back(ViewsOf(camera, world.detections));
    }
    const auto solve = [&](std::vector<CameraViews> views) {
      return CalibrateByBoards(world.rig.target, Brief(), std::move(views));
    };
    CalibratedCameras calibrated = solve(cameras);
    calibrated.mount_breaks = {{"0003", "0004"}, {"0005", "0006"}};
    calibrated = WithMovedMountNamed(std::move(calibrated), cameras, solve);
    for (const CameraViews& camera : calibrated.cameras) {
      EXPECT_EQ(MountIn(camera.report), nullptr) << seed;
    }
  }
}

// One camera's, while the other stands firm.
TEST(MountMoved, IsSaidOfTheCameraThatMoved) {
  SolveWorld firm(Drawn(5, 6));
  SolveWorld world = MovedAfter(6, 5, 5);
  for (std::size_t v = 6; v < world.detections.size(); ++v) {
    firm.AddView(world.lidar_from_target[v]);
    world.detections[v].images[1] = firm.detections[v].images[1];
  }
  const Report report = Calibrate(world.rig, world.detections);
  EXPECT_NE(MountIn(report.cameras[0]), nullptr);
  EXPECT_EQ(MountIn(report.cameras[1]), nullptr);
}

TEST(MountMoved, IsNotWhatAWrongLensShows) {
  for (std::uint32_t seed = 1; seed <= 4; ++seed) {
    SolveWorld world(Drawn(seed, 9));
    world.rig.cameras[0].lens.fx *= 1.02;
    world.rig.cameras[0].lens.fy *= 1.02;
    for (const CameraReport& camera : Calibrate(world.rig, world.detections).cameras) {
      EXPECT_EQ(MountIn(camera), nullptr) << seed;
    }
  }
}

}  // namespace
}  // namespace rgbdt
