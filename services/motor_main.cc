#include <CLI/CLI.hpp>
#include <cstdio>

#include "calib/files/schema/rig_file.h"
#include "calib/model/version.h"
#include "services/drivers/dynamixel/motor_node.h"
#include "services/runtime/process.h"

int main(int argc, char** argv) {
  CLI::App app{
      "The Dynamixel servo (Protocol 2.0) that turns the rig's 2D scanner: ENCODER all the time,\n"
      "a sweep on SESSION_COMMAND. Sets the servo's Return Delay Time to 0.\n"
      "Example: rgbdt-motor --rig rig.textproto",
      "rgbdt-motor"};
  std::string url;
  std::string rig_file;
  app.add_option("--rig", rig_file, "rig.textproto with lidar.turned_scanner.dynamixel")
      ->required();
  app.add_option("--lcm-url", url, "the bus; default: LCM_DEFAULT_URL");
  app.set_version_flag("--version", rgbdt::Version());
  CLI11_PARSE(app, argc, argv);
  try {
    rgbdt::MotorNode node(rgbdt::ReadRig(rig_file, rgbdt::LensNeed::kMayBeUnknown).lidar);
    return rgbdt::RunOnLcm(node, url);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "rgbdt-motor: %s\n", e.what());
    return 1;
  }
}
