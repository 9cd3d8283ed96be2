#include "calib/odometry/odometry.h"
#include "services/command_line/command_line.h"
#include "services/nodes/odometry_node.h"
#include "services/runtime/process.h"

int main(int argc, char** argv) {
  rgbdt::CommandLine line(
      "rgbdt-odometry",
      "Where a LIDAR is, from its sweeps alone: CLOUD to POSE, one a sweep. "
      "Fuser, monitor and\n"
      "mapper then make maps of a drive with nothing else on the bus. A spinning "
      "LIDAR may move\n"
      "while it sweeps; the rig of a turned scanner stands for each sweep and "
      "goes on by a metre\n"
      "or two in between or, from the second sweep on, drives slowly "
      "meanwhile. What the\n"
      "surroundings do not tell, as a corridor the way along it, the status names.\n"
      "Example: rgbdt-odometry --lcm-url 'udpm://239.255.76.67:7667?ttl=0'");
  rgbdt::BusFlags bus;
  rgbdt::OdometryOptions options;
  line.Bus(&bus.url, &bus.key);
  line.Option("--min-range", &options.min_range_m, "nearer points are the rig's own [m]");
  line.Option("--max-range", &options.max_range_m, "farther points are left out [m]");
  return line.Run(argc, argv, [&] {
    rgbdt::OdometryNode node(options);
    return rgbdt::RunOnLcm(node, bus);
  });
}
