#include "services/command_line/command_line.h"
#include "services/nodes/solver_node.h"
#include "services/runtime/process.h"

int main(int argc, char** argv) {
  rgbdt::CommandLine line(
      "rgbdt-solver",
      "DETECTION to CALIBRATION: where each camera sits relative to the LIDAR.\nExample: "
      "rgbdt-solver --lcm-url 'udpm://239.255.76.67:7667?ttl=0'");
  rgbdt::BusFlags bus;
  line.Bus(&bus.url, &bus.key);
  std::string method = rgbdt::kAutoMethod;
  line.Choice("--method", &method, rgbdt::kBusMethodNames, rgbdt::kBusMethodHelp);
  return line.Run(argc, argv, [&] {
    rgbdt::CalibrateOptions options;
    options.method = method;
    rgbdt::SolverNode node(options);
    return rgbdt::RunOnLcm(node, bus);
  });
}
