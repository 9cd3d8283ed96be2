#include "services/nodes/monitor_node.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/nodes/fuser_node.h"
#include "services/nodes/shot_collector.h"
#include "tests/nodes/nodes_testing.h"
#include "tests/nodes/twins.h"
#include "tests/numbers.h"
#include "tests/unit/methods/scene/scene_world.h"

namespace rgbdt {
namespace {

using test::Counter;
using test::Only;
using ::testing::Each;
using ::testing::Gt;
using ::testing::HasSubstr;

// A furnished room, one sweep a second.
const SceneWorld& Room() {
  static const SceneWorld world(6, [] {
    simulate::Options options = SmallScene();
    options.scene = simulate::Scene::kIndoor;
    options.natural.on = true;
    return options;
  }());
  return world;
}

const Rig& RoomRig() {
  static const Rig rig = ParseRig(PrintRig(Room().rig()), "rig of the room");
  return rig;
}

CalibrationMessage Calibrated(std::size_t camera, const Rigid3& off = {}) {
  CalibrationMessage message;
  message.utime = 5;
  message.rig_hash = RoomRig().hash;
  message.method = "auto";
  message.calibration.camera = RoomRig().cameras[camera].name;
  message.calibration.camera_from_lidar = off * Room().Truth(camera);
  message.calibration.status = SolveStatus::kConverged;
  message.calibration.covariance = Matrix6d(1e-7 * Matrix6d::Identity());
  return message;
}

CloudChunk WholeSweep(Cloud cloud) {
  CloudChunk chunk;
  chunk.sweep_end = true;
  chunk.sweep_lines = cloud.lines;
  chunk.cloud = std::move(cloud);
  return chunk;
}

// Images, then the sweep, view by view.
Messages DriveMessages() {
  Messages messages;
  const std::size_t cameras = RoomRig().cameras.size();
  for (std::size_t v = 0; v < Room().clouds.size(); ++v) {
    for (std::size_t c = 0; c < cameras; ++c) {
      messages.emplace_back(Room().images[v * cameras + c]);
    }
    messages.emplace_back(WholeSweep(Room().clouds[v]));
  }
  return messages;
}

MonitorOptions EverySweep() {
  MonitorOptions options;
  options.every = 0;
  return options;
}

std::vector<MountCheck> Watch(MonitorNode* node, const Messages& messages) {
  std::vector<MountCheck> checks;
  for (const Message& message : messages) {
    for (const MountCheck& check : Only<MountCheck>(node->Handle(message))) {
      checks.push_back(check);
    }
  }
  return checks;
}

TEST(MonitorNode, SaysOfEachCameraWhetherItHolds) {
  MonitorNode node(EverySweep());
  EXPECT_THAT(node.GetStatus().text, HasSubstr("waits for the rig"));
  node.Handle(test::TextOf(RoomRig()));
  EXPECT_THAT(node.GetStatus().text, HasSubstr("waits for a calibration"));
  node.Handle(Calibrated(0));
  node.Handle(Calibrated(1, RotationAbout(Eigen::Vector3d::UnitY(), 1.2 * kDegree)));
  EXPECT_THAT(node.GetStatus().text, HasSubstr("waits for a sweep"));
  std::vector<std::string> warnings;
  node.SetWarningHandler([&](const std::string& warning) { warnings.push_back(warning); });
  const std::vector<MountCheck> checks = Watch(&node, DriveMessages());
  ASSERT_EQ(checks.size(), 12U);
  const MountCheck &rgb = checks[10], &thermal = checks[11];
  EXPECT_EQ(rgb.state, MountState::kHolds) << rgb.text;
  EXPECT_EQ(thermal.state, MountState::kMoved) << thermal.text;
  EXPECT_EQ(rgb.calibration_utime, 5);
  EXPECT_LT(ErrorOf(thermal.camera_from_lidar, Room().Truth(1)).rotation_deg, 0.3);
  const Status status = node.GetStatus();
  EXPECT_THAT(status.text, HasSubstr("rgb holds"));
  EXPECT_THAT(status.text, HasSubstr("thermal moved by 1."));
  EXPECT_EQ(Counter(status, "looked at"), 6);
  EXPECT_EQ(Counter(status, "alarms"), 1);
  ASSERT_EQ(warnings.size(), 1U) << "an alarm is told once";
  EXPECT_THAT(warnings[0], HasSubstr("thermal moved"));
}

TEST(MonitorNode, OfSweepsThatComeFastOneIsLookedAtNowAndThen) {
  MonitorNode node;  // every two seconds
  node.Handle(test::TextOf(RoomRig()));
  node.Handle(Calibrated(0));
  EXPECT_EQ(Watch(&node, DriveMessages()).size(), 3U);
  EXPECT_EQ(Counter(node.GetStatus(), "sweeps"), 6);
  // The clock is set back: time begins anew.
  CloudChunk early = WholeSweep(Room().clouds[0]);
  early.cloud.sweep_utime -= 100 * kSecond;
  for (Utime& utime : early.cloud.utime) utime -= 100 * kSecond;
  node.Handle(early);
  EXPECT_EQ(Counter(node.GetStatus(), "looked at"), 4);
  EXPECT_EQ(Counter(node.GetStatus(), "without an image or a pose of their time"), 1);
}

// 3 degrees within each sweep.
Rigid3 MapFromRig(Utime utime, Utime sweep) {
  Vector6d twist;
  twist << 0, 0, 0.5, 1, 0, 0;
  return Exp(Vector6d(ToSeconds(utime - sweep) * twist));
}

Messages DriveInMotion(bool with_poses) {
  Messages messages;
  for (Message& message : DriveMessages()) {
    auto* chunk = std::get_if<CloudChunk>(&message);
    if (chunk == nullptr) {
      messages.push_back(std::move(message));
      continue;
    }
    Cloud& cloud = chunk->cloud;
    const Utime sweep = cloud.sweep_utime;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const Rigid3 then_from_image = MapFromRig(cloud.utime[i], sweep).Inverse();
      cloud.points[i] = (then_from_image * cloud.points[i].cast<double>().eval()).cast<float>();
      if (cloud.directions.empty()) continue;
      cloud.directions[i] =
          (then_from_image.rotation * cloud.directions[i].cast<double>()).cast<float>();
    }
    for (int i = -1; with_poses && i <= 3; ++i) {
      StampedPose pose;
      pose.utime = sweep + i * kSecond / 10;
      pose.source = "odometry";
      pose.map_from_lidar = MapFromRig(pose.utime, sweep);
      messages.emplace_back(pose);
    }
    messages.push_back(std::move(message));
  }
  return messages;
}

TEST(ShotCollector, AClocksOffsetTellsWhichImageIsOfTheSweepsTime) {
  Cloud sweep = Room().clouds[0];
  sweep.utime.clear();  // all of it at its start
  ShotCollector shots;
  const CameraTiming late{{-0.5, 1e-4}, {0, 1e-5}};
  for (const Utime after : {Utime{0}, kSecond / 2}) {
    Image image = Room().images[0];
    image.utime = sweep.sweep_utime + after;
    shots.Add(image, late);
  }
  const auto shot = shots.ShotOf(sweep, RoomRig().cameras[0], Room().Truth(0));
  ASSERT_TRUE(shot);
  EXPECT_EQ(shot->taken, sweep.sweep_utime);
  EXPECT_EQ(shot->image.utime, sweep.sweep_utime + kSecond / 2);  // by its own clock still
}

TEST(MonitorNode, PosesTakeTheRigsMotionOut) {
  for (const bool with_poses : {true, false}) {
    MonitorNode node(EverySweep());
    node.Handle(test::TextOf(RoomRig()));
    node.Handle(Calibrated(0));
    const std::vector<MountCheck> checks = Watch(&node, DriveInMotion(with_poses));
    ASSERT_EQ(checks.size(), 6U);
    const bool holds = checks.back().state == MountState::kHolds;
    EXPECT_EQ(holds, with_poses) << checks.back().text;
  }
}

TEST(MonitorNode, SendsTheCalibrationThatItIsGiven) {
  GivenCalibration given{RoomRig(), {}};
  given.calibration.rig_hash = RoomRig().hash;
  given.calibration.utime = 7;
  given.calibration.cameras = {Calibrated(0).calibration, Calibrated(1).calibration};
  MonitorNode node(EverySweep(), given);
  const Messages said = node.Advance(0);
  ASSERT_EQ(Only<RigText>(said).size(), 1U);
  EXPECT_EQ(Only<RigText>(said)[0].hash, RoomRig().hash);
  ASSERT_EQ(Only<CalibrationMessage>(said).size(), 2U);
  EXPECT_TRUE(node.Advance(kSecond / 2).empty());
  EXPECT_EQ(node.Advance(kSecond).size(), 3U);
  FuserNode fuser;
  for (const Message& message : said) fuser.Handle(message);
  EXPECT_TRUE(fuser.HasCalibrations());
  EXPECT_EQ(Watch(&node, DriveMessages()).back().calibration_utime, 7);
  given.calibration.cameras[0].status = SolveStatus::kContradicted;
  EXPECT_THROW(MonitorNode(EverySweep(), given), InputError);
}

TEST(MonitorNode, WhatIsNotToBeUsedIsNotWatched) {
  MonitorNode node(EverySweep());
  node.Handle(test::TextOf(RoomRig()));
  CalibrationMessage bad = Calibrated(0);
  bad.calibration.status = SolveStatus::kDegenerate;
  node.Handle(bad);
  EXPECT_TRUE(Watch(&node, DriveMessages()).empty());
  EXPECT_THAT(node.GetStatus().text, HasSubstr("rgb is not watched"));
}

TEST(MonitorNode, RefusesAndIsAsBefore) {
  MonitorNode node(EverySweep()), twin(EverySweep());
  test::Twins twins(&node, &twin);
  Image small = Room().images[0];
  small.pixels = cv::Mat(4, 4, small.pixels.type(), cv::Scalar(0));
  Image stranger = Room().images[0];
  stranger.camera = "front";
  CalibrationMessage of_another = Calibrated(0);
  of_another.rig_hash = "another rig's";
  CloudChunk endless = WholeSweep(Room().clouds[0]);
  endless.cloud.first_line = 1'000'000'000;
  twins.bad = {RigText{0, "another hash", "cameras { nonsense }"}, small, stranger, of_another,
               endless};
  Messages good = {test::TextOf(RoomRig()), Calibrated(0)};
  for (Message& message : DriveMessages()) good.push_back(std::move(message));
  twins.Feed(good);
  EXPECT_THAT(twins.refused, Each(Gt(10)));
}

}  // namespace
}  // namespace rgbdt
