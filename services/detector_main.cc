#include "services/command_line/command_line.h"
#include "services/nodes/detector_node.h"
#include "services/runtime/process.h"

int main(int argc, char** argv) {
  rgbdt::CommandLine line(
      "rgbdt-detector",
      "On a capture command: the target's edges in images and cloud (DETECTION).\nExample: "
      "rgbdt-detector --lcm-url 'udpm://239.255.76.67:7667?ttl=0'");
  rgbdt::BusFlags bus;
  line.Bus(&bus.url, &bus.key);
  std::string method = rgbdt::kAutoMethod;
  line.Choice("--method", &method, rgbdt::kBusMethodNames, rgbdt::kBusMethodHelp);
  return line.Run(argc, argv, [&] {
    rgbdt::DetectorNode node(method);
    return rgbdt::RunOnLcm(node, bus);
  });
}
