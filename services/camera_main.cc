#include <CLI/CLI.hpp>
#include <cstdio>

#include "calib/files/schema/rig_file.h"
#include "calib/model/version.h"
#include "services/drivers/camera/camera_node.h"
#include "services/runtime/process.h"

int main(int argc, char** argv) {
  CLI::App app{
      "A GigE Vision or USB3 Vision camera, colour or thermal, on the bus: <CAMERA>_IMAGE.\n"
      "One process a camera; how to reach and set it stands in the rig file.\n"
      "Example: rgbdt-camera --rig field.rig.textproto --camera thermal",
      "rgbdt-camera"};
  std::string url;
  std::string rig_file;
  std::string name;
  std::string captures = "out/captures";
  app.add_option("--rig", rig_file, "rig.textproto")->required();
  app.add_option("--camera", name, "which of its cameras; not needed where only one has a device");
  app.add_option("--captures", captures,
                 "where captured views stay raw when JPEG or PNG goes over the bus")
      ->capture_default_str();
  app.add_option("--lcm-url", url, "the bus; default: LCM_DEFAULT_URL");
  app.set_version_flag("--version", rgbdt::Version());
  CLI11_PARSE(app, argc, argv);
  try {
    rgbdt::CameraNode node(rgbdt::ReadRig(rig_file, rgbdt::LensNeed::kMayBeUnknown), name,
                           captures);
    return rgbdt::RunOnLcm(node, url);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "rgbdt-camera: %s\n", e.what());
    return 1;
  }
}
