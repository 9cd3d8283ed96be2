#include "services/command_line/command_line.h"
#include "services/nodes/mapper_node.h"
#include "services/runtime/process.h"

int main(int argc, char** argv) {
  rgbdt::CommandLine line(
      "rgbdt-mapper",
      "RGBDT_CLOUD to a map of voxels, each with its mean colour and temperature: a PLY file,\n"
      "written every few seconds and at the end (SIGINT, SIGTERM).\n"
      "Example: rgbdt-mapper --voxel 0.1 --out out/map.ply");
  rgbdt::BusFlags bus;
  std::string out = "map.ply";
  double every_s = 5;
  rgbdt::VoxelMapOptions options;
  line.Bus(&bus.url, &bus.key);
  line.Option("--voxel", &options.voxel_m, "edge of a voxel [m]");
  line.Option("--max-voxels", &options.max_voxels,
              "more, and those not seen for the longest go; 80 bytes each");
  line.Option("--out", &out, "the map");
  line.Within("--every", &every_s, 0.1, 86400.0, "seconds from one writing to the next");
  return line.Run(argc, argv, [&] {
    rgbdt::MapperNode node(options, out, rgbdt::FromSeconds(every_s));
    const int code = rgbdt::RunOnLcm(node, bus);
    node.Save();
    return code;
  });
}
