#include <CLI/CLI.hpp>

#include "calib/files/schema/rig_file.h"
#include "calib/model/errors.h"
#include "calib/model/version.h"
#include "services/drivers/dynamixel/motor_node.h"
#include "services/runtime/process.h"

namespace {

// The rig's turned scanner, which has a motor that can be driven.
rgbdt::TurnedScanner ReadScanner(const std::string& rig_file) {
  const rgbdt::Rig rig = rgbdt::ReadRig(rig_file, rgbdt::LensNeed::kMayBeUnknown);
  const auto& scanner = rig.lidar.turned_scanner;
  if (!scanner) {
    throw rgbdt::InputError(rig_file +
                            ": the lidar has no turned_scanner, so there is no motor to drive");
  }
  if (!scanner->motor) {
    throw rgbdt::InputError(
        rig_file +
        ": lidar.turned_scanner has no dynamixel section; add to it, with your own values: "
        "dynamixel { port: \"/dev/ttyUSB0\" baud: 57600 id: 1 from_deg: -90 to_deg: 90 "
        "speed_deg_s: 20 }");
  }
  return *scanner;
}

}  // namespace

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
    rgbdt::MotorNode node(ReadScanner(rig_file));
    return rgbdt::RunOnLcm(node, url);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "rgbdt-motor: %s\n", e.what());
    return 1;
  }
}
