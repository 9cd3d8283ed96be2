#include <CLI/CLI.hpp>
#include <cstdio>

#include "calib/model/version.h"
#include "services/nodes/mapper_node.h"
#include "services/runtime/process.h"

int main(int argc, char** argv) {
  CLI::App app{
      "RGBDT_CLOUD to a map of voxels, each with its mean colour and temperature: a PLY file,\n"
      "written every few seconds and at the end (SIGINT, SIGTERM).\n"
      "Example: rgbdt-mapper --voxel 0.1 --out out/map.ply",
      "rgbdt-mapper"};
  std::string url, out = "map.ply";
  double every_s = 5;
  rgbdt::VoxelMapOptions options;
  app.add_option("--lcm-url", url, "the bus; default: LCM_DEFAULT_URL");
  app.add_option("--voxel", options.voxel_m, "edge of a voxel [m]")->capture_default_str();
  app.add_option("--max-voxels", options.max_voxels,
                 "more, and those not seen for the longest go; 80 bytes each")
      ->capture_default_str();
  app.add_option("--out", out, "the map")->capture_default_str();
  app.add_option("--every", every_s, "seconds from one writing to the next")
      ->check(CLI::Range(0.1, 86400.0))
      ->capture_default_str();
  app.set_version_flag("--version", rgbdt::Version());
  CLI11_PARSE(app, argc, argv);
  try {
    rgbdt::MapperNode node(options, out, rgbdt::FromSeconds(every_s));
    const int code = rgbdt::RunOnLcm(node, url);
    node.Save();
    return code;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "rgbdt-mapper: %s\n", e.what());
    return 1;
  }
}
