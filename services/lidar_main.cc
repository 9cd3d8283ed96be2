#include "calib/files/schema/rig_file.h"
#include "services/command_line/command_line.h"
#include "services/drivers/lidar/lidar_node.h"
#include "services/runtime/process.h"

int main(int argc, char** argv) {
  rgbdt::CommandLine line(
      "rgbdt-lidar",
      "A LIDAR on the bus: a Hokuyo scanner over TCP (LINE_SCAN), or a Velodyne, Ouster, Hesai,\n"
      "Livox or RoboSense over UDP, a recording of its packets or a folder of PCD files (CLOUD). "
      "Which one, "
      "and\n"
      "where, stands in the rig file: lidar { hokuyo { address: \"192.168.0.10\" } }, or\n"
      "velodyne { ... }, ouster { metadata: \"os1.json\" }, hesai { ... }, livox { },\n"
      "robosense { }, pcd_folder { ... }. A device that goes away is waited for; a recording's end "
      "ends it.\n"
      "Example: rgbdt-lidar --rig rig.textproto");
  rgbdt::BusFlags bus;
  std::string rig_file;
  line.Required("--rig", &rig_file, "rig.textproto");
  line.Bus(&bus.url, &bus.key);
  return line.Run(argc, argv, [&] {
    rgbdt::LidarNode node(rgbdt::ReadRig(rig_file, rgbdt::LensNeed::kMayBeUnknown).lidar);
    return rgbdt::RunOnLcm(node, bus);
  });
}
