#include <gmock/gmock.h>

#include <filesystem>

#include "services/drivers/camera/camera_node.h"
#include "services/drivers/dynamixel/motor_node.h"
#include "services/drivers/lidar/lidar_node.h"
#include "tests/unit/files/test_data.h"

namespace rgbdt {
namespace {

// Whatever the bus says to a device's node, it refuses nothing: what it cannot do is an event.
TEST(DeviceNodes, TakeAnyMessage) {
  const test::TempDir dir;
  TurnedScanner scanner;
  scanner.motor = DynamixelDevice();
  scanner.motor->port = (dir / "nothing").string();
  CameraSpec camera;
  camera.name = "rgb";
  camera.device = CameraDevice();
  camera.device->serial = "no such camera";
  std::filesystem::create_directories(dir / "clouds");
  test::WriteQuickly(dir / "clouds" / "1.pcd", "no PCD file");
  LidarSpec lidar;
  lidar.device = PcdFolderDevice{(dir / "clouds").string(), 0.1};
  MotorNode motor(scanner);
  CameraNode camera_node(camera, dir / "captures");
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

}  // namespace
}  // namespace rgbdt
