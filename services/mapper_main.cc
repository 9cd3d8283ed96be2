#include <cstdio>
#include <string>

#include "calib/files/check_writable.h"
#include "calib/files/keep_aside.h"
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
  line.Option("--out", &out, "the map; one that is there is kept beside it, as map.1.ply");
  line.Within("--every", &every_s, 0.1, 86400.0, "seconds from one writing to the next");
  return line.Run(argc, argv, [&] {
    rgbdt::CheckWritable(out);
    // One that is there is another drive's, or what this one had before the mapper died.
    if (const auto kept = rgbdt::KeepAside(out); !kept.empty()) {
      std::printf("the map that was there is %s now\n", kept.c_str());
    }
    rgbdt::MapperNode node(options, out, rgbdt::FromSeconds(every_s));
    const int code = rgbdt::RunOnLcm(node, bus);
    node.Save();
    return code;
  });
}
