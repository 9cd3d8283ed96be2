#include "services/command_line/command_line.h"
#include "services/nodes/assembler_node.h"
#include "services/runtime/process.h"

int main(int argc, char** argv) {
  rgbdt::CommandLine line(
      "rgbdt-assembler",
      "LINE_SCAN and ENCODER to CLOUD: a turned 2D scanner's lines become 3D.\nExample: "
      "rgbdt-assembler --lcm-url 'udpm://239.255.76.67:7667?ttl=0'");
  rgbdt::BusFlags bus;
  line.Bus(&bus.url, &bus.key);
  return line.Run(argc, argv, [&] {
    rgbdt::AssemblerNode node;
    return rgbdt::RunOnLcm(node, bus);
  });
}
