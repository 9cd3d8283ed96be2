#include <cstdio>
#include <memory>

#include "calib/files/points/map_files.h"
#include "calib/model/errors.h"
#include "services/bus/log.h"
#include "services/messages/codec.h"
#include "services/nodes/mapper_node.h"
#include "services/rgbdt/verbs.h"

namespace rgbdt {
namespace {

struct MapFlags {
  std::string log, out = "map.ply";
  VoxelMapOptions options;
};

/// What a log gave.
struct LogRead {
  std::int64_t events = 0, clouds = 0, dropped = 0;
  std::string last_problem;
};

// As a process does: what cannot be used is dropped and counted, not the end.
LogRead ReadLog(const std::string& path, MapperNode* node) {
  LogReader log(path);
  LogRead read;
  while (const auto event = log.Next()) {
    ++read.events;
    if (event->channel != "RGBDT_CLOUD") continue;
    try {
      node->Handle(Decode(event->channel, event->bytes.data(), event->bytes.size()));
      ++read.clouds;
    } catch (const std::exception& e) {
      ++read.dropped;
      read.last_problem = e.what();
    }
  }
  if (log.unreadable_bytes() > 0) {
    std::fprintf(stderr, "%s: %lld bytes belong to no whole message; was the logger killed?\n",
                 path.c_str(), static_cast<long long>(log.unreadable_bytes()));
  }
  return read;
}

int RunMap(const MapFlags& flags) {
  flags.options.Check();
  MapperNode node(flags.options);
  const LogRead read = ReadLog(flags.log, &node);
  if (read.dropped > 0) {
    std::fprintf(stderr, "%s: %lld messages dropped; last problem: %s\n", flags.log.c_str(),
                 static_cast<long long>(read.dropped), read.last_problem.c_str());
  }
  if (node.map().size() == 0) {
    throw InputError(flags.log + ": none of its " + std::to_string(read.events) +
                     " messages is a fused cloud with points (RGBDT_CLOUD); record that channel, "
                     "as rgbdt-fuser publishes it");
  }
  const MapCloud map = node.map().Cloud();
  WriteMapPly(flags.out, map);
  std::printf(
      "%lld clouds, %lld points in %zu voxels of %g m, frame %s; wrote %s\n",
      static_cast<long long>(read.clouds), static_cast<long long>(node.map().points()), map.size(),
      map.voxel_m,
      map.frame == "map" ? "of the pose stream" : "LIDAR (no poses: a rig that stands still)",
      flags.out.c_str());
  if (node.map().evicted() > 0) {
    std::printf("the map was full: %lld voxels went; take larger ones, or --max-voxels\n",
                static_cast<long long>(node.map().evicted()));
  }
  std::printf("next: rgbdt terrain %s\n", flags.out.c_str());
  return EndsWith(true);
}

}  // namespace

void AddMap(CommandLine* program) {
  auto flags = std::make_shared<MapFlags>();
  CommandLine* verb = program->Verb(
      "map",
      "Fused clouds of a log (RGBDT_CLOUD) to a map of voxels, in the pose stream's frame: mean\n"
      "place, colour, temperature [K], count, last seen. rgbdt-mapper does it live.\n"
      "Example: rgbdt map session.lcmlog --voxel 0.1 --out out/map.ply",
      [flags] { return RunMap(*flags); });
  verb->Required("LOG", &flags->log, "log written by lcm-logger");
  verb->Option("--out", &flags->out, "the map, a PLY file");
  verb->Option("--voxel", &flags->options.voxel_m, "edge of a voxel [m]");
  verb->Option("--max-voxels", &flags->options.max_voxels,
               "most voxels kept (80 bytes each); then those not seen for the longest are dropped");
}

}  // namespace rgbdt
