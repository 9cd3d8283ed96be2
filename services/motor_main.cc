#include "calib/files/schema/rig_file.h"
#include "services/command_line/command_line.h"
#include "services/drivers/dynamixel/motor_node.h"
#include "services/runtime/process.h"

int main(int argc, char** argv) {
  rgbdt::CommandLine line(
      "rgbdt-motor",
      "The Dynamixel servo (Protocol 2.0) that turns the rig's 2D scanner: ENCODER all the time,\n"
      "a sweep on SESSION_COMMAND. Sets the servo's Return Delay Time to 0.\n"
      "Example: rgbdt-motor --rig rig.textproto");
  rgbdt::BusFlags bus;
  std::string rig_file;
  line.Required("--rig", &rig_file, "rig.textproto with lidar.turned_scanner.dynamixel");
  line.Bus(&bus.url, &bus.key);
  return line.Run(argc, argv, [&] {
    rgbdt::MotorNode node(rgbdt::ReadRig(rig_file, rgbdt::LensNeed::kMayBeUnknown).lidar);
    return rgbdt::RunOnLcm(node, bus);
  });
}
