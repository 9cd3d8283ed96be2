#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>

#include "calib/files/points/map_files.h"
#include "calib/model/errors.h"
#include "calib/model/version.h"
#include "services/nodes/mapper_node.h"
#include "services/runtime/process.h"

namespace {

/// Writes the map when it has changed, at most every so many seconds, and no more than a tenth of
/// the time: a large map takes long to write.
class MapSaver {
 public:
  MapSaver(const rgbdt::MapperNode* node, std::string path, double every_s)
      : node_(node), path_(std::move(path)), every_s_(every_s) {}

  void SaveIfDue() {
    if (Seconds() < due_s_) return;
    const double began = Seconds();
    // A full disk may have room again; the map itself is not lost.
    try {
      Save();
    } catch (const rgbdt::InputError& e) {
      spdlog::warn("mapper: {}", e.what());
    }
    due_s_ = Seconds() + std::max(every_s_, 10 * (Seconds() - began));
  }

  void Save() {
    if (node_->map().points() == saved_points_) return;
    rgbdt::WriteMapPly(path_, node_->map().Cloud());
    saved_points_ = node_->map().points();
  }

 private:
  static double Seconds() {
    using Clock = std::chrono::steady_clock;
    return std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
  }

  const rgbdt::MapperNode* node_;
  std::string path_;
  double every_s_;
  double due_s_ = 0;
  std::int64_t saved_points_ = 0;
};

}  // namespace

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
    rgbdt::MapperNode node(options);
    MapSaver saver(&node, out, every_s);
    const int code = rgbdt::RunOnLcm(node, url, [&](rgbdt::NodeRunner&) {
      saver.SaveIfDue();
      return true;
    });
    saver.Save();
    return code;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "rgbdt-mapper: %s\n", e.what());
    return 1;
  }
}
