#include <cstdio>
#include <filesystem>
#include <string>

#include "calib/files/atomic_file.h"
#include "calib/files/check_writable.h"
#include "services/command_line/command_line.h"
#include "services/nodes/mapper_node.h"
#include "services/runtime/process.h"

namespace {

// A map that is there is another drive's, or what this one had before the mapper died.
void SetAside(const std::filesystem::path& map) {
  if (!std::filesystem::exists(map)) return;
  std::filesystem::path kept;
  for (int i = 1; kept.empty() || std::filesystem::exists(kept); ++i) {
    kept = map.parent_path() /
           (map.stem().string() + "_" + std::to_string(i) + map.extension().string());
  }
  rgbdt::Rename(map, kept);
  std::printf("the map that was there is %s now\n", kept.c_str());
}

}  // namespace

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
  line.Option("--out", &out, "the map; one that is there is kept beside it, as map_1.ply");
  line.Within("--every", &every_s, 0.1, 86400.0, "seconds from one writing to the next");
  return line.Run(argc, argv, [&] {
    rgbdt::CheckWritable(out);
    SetAside(out);
    rgbdt::MapperNode node(options, out, rgbdt::FromSeconds(every_s));
    const int code = rgbdt::RunOnLcm(node, bus);
    node.Save();
    return code;
  });
}
