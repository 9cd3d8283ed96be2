#include <CLI/CLI.hpp>
#include <cstdio>

#include "calib/files/schema/rig_file.h"
#include "calib/model/version.h"
#include "services/drivers/lidar/lidar_node.h"
#include "services/runtime/process.h"

int main(int argc, char** argv) {
  CLI::App app{
      "A LIDAR on the bus: a Hokuyo scanner over TCP (LINE_SCAN), or a Velodyne over UDP, a\n"
      "recording of its packets or a folder of PCD files (CLOUD). Which one, and where, stands in\n"
      "the rig file: lidar { hokuyo { address: \"192.168.0.10\" } }, or velodyne { ... }, or\n"
      "pcd_folder { ... }. A device that goes away is waited for; a recording's end ends it.\n"
      "Example: rgbdt-lidar --rig rig.textproto",
      "rgbdt-lidar"};
  std::string url;
  std::string rig_file;
  app.add_option("--rig", rig_file, "rig.textproto")->required();
  app.add_option("--lcm-url", url, "the bus; default: LCM_DEFAULT_URL");
  app.set_version_flag("--version", rgbdt::Version());
  CLI11_PARSE(app, argc, argv);
  try {
    rgbdt::LidarNode node(rgbdt::ReadRig(rig_file, rgbdt::LensNeed::kMayBeUnknown).lidar);
    return rgbdt::RunOnLcm(node, url);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "rgbdt-lidar: %s\n", e.what());
    return 1;
  }
}
