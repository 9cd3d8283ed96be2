#include "calib/methods/calibrate_without.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calib/model/errors.h"
#include "tests/unit/solve/solve_world.h"

namespace rgbdt {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::Not;

SolveWorld World() {
  SolveWorldOptions options;
  options.views = 8;
  return SolveWorld(options);
}

CalibrateOptions Quick() {
  CalibrateOptions options;
  options.diagnostics = false;
  return options;
}

TEST(CalibrateWithout, IsTheCalibrationOfTheOtherViews) {
  const SolveWorld world = World();
  const std::string out = world.detections[2].view;
  std::vector<ViewDetection> others = world.detections;
  others.erase(others.begin() + 2);
  const Report expected = Calibrate(world.rig, others, Quick());
  const Report report = CalibrateWithout(world.rig, world.detections, {out}, Quick());
  ASSERT_EQ(report.cameras.size(), expected.cameras.size());
  for (std::size_t i = 0; i < report.cameras.size(); ++i) {
    const CameraReport& camera = report.cameras[i];
    EXPECT_EQ(CentreDistance(camera.calibration.camera_from_lidar,
                             expected.cameras[i].calibration.camera_from_lidar),
              0);
    EXPECT_THAT(camera.used, Not(Contains(out)));
    EXPECT_THAT(camera.warnings, Contains("Left out by hand: " + out));
  }
}

TEST(CalibrateWithout, WithNothingLeftOutItIsTheSameAndSaysNothing) {
  const SolveWorld world = World();
  const Report report = CalibrateWithout(world.rig, world.detections, {}, Quick());
  EXPECT_EQ(report.cameras[0].used.size(), 8U);
  EXPECT_EQ(report.cameras[0].warnings,
            Calibrate(world.rig, world.detections, Quick()).cameras[0].warnings);
}

TEST(CalibrateWithout, OneViewHasToRemain) {
  const SolveWorld world = World();
  std::set<std::string> all;
  for (const ViewDetection& detection : world.detections) all.insert(detection.view);
  EXPECT_THROW(CalibrateWithout(world.rig, world.detections, all, Quick()), InputError);
}

}  // namespace
}  // namespace rgbdt
