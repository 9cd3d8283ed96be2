#include "calib/files/schema/rig_file.h"
#include "services/bus/bus.h"
#include "services/bus/bus_url.h"
#include "services/command_line/command_line.h"
#include "services/drivers/camera/camera_node.h"
#include "services/runtime/process.h"

int main(int argc, char** argv) {
  rgbdt::CommandLine line(
      "rgbdt-camera",
      "A GigE Vision or USB3 Vision camera, colour or thermal, on the bus: <CAMERA>_IMAGE.\n"
      "One process a camera; how to reach and set it stands in the rig file.\n"
      "Example: rgbdt-camera --rig field.rig.textproto --camera thermal");
  rgbdt::BusFlags bus;
  std::string rig_file;
  std::string name;
  std::string captures = "out/captures";
  line.Required("--rig", &rig_file, "rig.textproto");
  line.Option("--camera", &name, "which of its cameras; not needed where only one has a device");
  line.Option("--captures", &captures,
              "where captured views stay raw when JPEG or PNG goes over the bus");
  line.Bus(&bus.url, &bus.key);
  return line.Run(argc, argv, [&] {
    rgbdt::CameraNode node(rgbdt::ReadRig(rig_file, rgbdt::LensNeed::kMayBeUnknown), name, captures,
                           rgbdt::ParseBusUrl(rgbdt::CompleteUrl(bus.url)).ttl > 0);
    return rgbdt::RunOnLcm(node, bus);
  });
}
