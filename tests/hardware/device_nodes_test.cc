#include <gmock/gmock.h>

#include <filesystem>

#include "calib/model/errors.h"
#include "services/drivers/camera/camera_node.h"
#include "services/drivers/dynamixel/motor_node.h"
#include "services/drivers/lidar/lidar_node.h"
#include "tests/unit/files/test_data.h"

namespace rgbdt {
namespace {

using ::testing::HasSubstr;

// Whatever the bus says to a device's node, it refuses nothing: what it cannot do is an event.
TEST(DeviceNodes, TakeAnyMessage) {
  const test::TempDir dir;
  LidarSpec turned;
  turned.turned_scanner.emplace();
  turned.turned_scanner->motor.emplace();
  turned.turned_scanner->motor->port = (dir / "nothing").string();
  CameraSpec camera;
  camera.name = "rgb";
  camera.device = CameraDevice();
  camera.device->serial = "no such camera";
  std::filesystem::create_directories(dir / "clouds");
  test::WriteQuickly(dir / "clouds" / "1.pcd", "no PCD file");
  LidarSpec lidar;
  lidar.device = PcdFolderDevice{(dir / "clouds").string(), 0.1};
  Rig rig;
  rig.cameras = {camera};
  MotorNode motor(turned);
  CameraNode camera_node(rig, "", dir / "captures", false);
  LidarNode lidar_node(lidar);
  for (DeviceNode* node : std::vector<DeviceNode*>{&motor, &camera_node, &lidar_node}) {
    for (const SessionVerb verb : {SessionVerb::kReset, SessionVerb::kNextPose, SessionVerb::kSweep,
                                   SessionVerb::kCapture, SessionVerb::kSolve}) {
      SessionCommand command;
      command.command = -1;
      command.verb = verb;
      command.view = "0001";
      EXPECT_NO_THROW(node->Handle(command)) << node->name();
    }
    EXPECT_NO_THROW(node->Handle(Status())) << node->name();
    EXPECT_NO_THROW(node->Advance(0)) << node->name();
  }
}

// Of several lines: they show what to add to the rig file.
template <typename Action>
std::string WordsOf(const Action& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(CameraNode, PacksWhatLeavesTheMachine) {
  using Wire = CameraDevice::Wire;
  CameraSpec colour, thermal;
  colour.kind = CameraKind::kColor;
  thermal.kind = CameraKind::kThermal;
  for (CameraSpec* camera : {&colour, &thermal}) camera->device.emplace();
  EXPECT_EQ(WireOf(colour, false), Wire::kRaw);
  EXPECT_EQ(WireOf(thermal, false), Wire::kRaw);
  EXPECT_EQ(WireOf(colour, true), Wire::kJpeg);
  EXPECT_EQ(WireOf(thermal, true), Wire::kPng);
  colour.device->wire = Wire::kRaw;
  thermal.device->wire = Wire::kJpeg;
  EXPECT_EQ(WireOf(colour, true), Wire::kRaw) << "as the rig file says";
  EXPECT_EQ(WireOf(thermal, false), Wire::kJpeg);
}

TEST(DeviceNodes, WithoutADeviceSayWhatToAdd) {
  LidarSpec lidar;
  EXPECT_THAT(WordsOf([&] { MotorNode node(lidar); }), HasSubstr("no turned_scanner"));
  lidar.turned_scanner.emplace();
  EXPECT_THAT(WordsOf([&] { MotorNode node(lidar); }), HasSubstr("dynamixel { port"));
  EXPECT_THAT(WordsOf([&] { LidarNode node(lidar); }), HasSubstr("hokuyo { address"));
  Rig rig;
  rig.cameras.resize(2);
  rig.cameras[0].name = "rgb";
  rig.cameras[1].name = "thermal";
  EXPECT_THAT(WordsOf([&] { CameraNode node(rig, "", "", false); }), HasSubstr("no camera in"));
  EXPECT_THAT(WordsOf([&] { CameraNode node(rig, "rgb", "", false); }),
              HasSubstr("how to reach camera \"rgb\""));
  for (CameraSpec& camera : rig.cameras) camera.device.emplace();
  EXPECT_THAT(WordsOf([&] { CameraNode node(rig, "", "", false); }),
              HasSubstr("--camera rgb or --camera thermal"));
}

}  // namespace
}  // namespace rgbdt
