#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>

#include "calib/files/atomic_file.h"
#include "calib/files/check_writable.h"
#include "calib/files/image_files.h"
#include "calib/files/points/map_files.h"
#include "calib/model/errors.h"
#include "calib/model/text.h"
#include "calib/odometry/comes_back.h"
#include "calib/present/pictures/map_picture.h"
#include "services/bus/log.h"
#include "services/messages/codec.h"
#include "services/nodes/mapper_node.h"
#include "services/replay/drive_map.h"
#include "services/rgbdt/verbs.h"
#include "services/rgbdt/write_terrain.h"

namespace rgbdt {
namespace {

struct MapFlags {
  std::string log, out = "map.ply";
  bool drive = false, close_loops = false, json = false;
  VoxelMapOptions options;
};

/// What a log gave.
struct LogRead {
  std::int64_t events = 0, clouds = 0, sweeps = 0, dropped = 0, unreadable_bytes = 0;
  std::string last_problem;
  std::vector<StampedPose> way;  // where clouds say that the rig was
};

void AddPose(const Message& message, std::vector<StampedPose>* way) {
  const auto* cloud = std::get_if<RgbdtCloud>(&message);
  if (cloud == nullptr || !cloud->map_from_lidar) return;
  if (!way->empty() && cloud->frame_utime <= way->back().utime) return;
  way->push_back({0, cloud->frame_utime, "", *cloud->map_from_lidar});
}

// As a process does: what cannot be used is dropped and counted, not the end.
LogRead ReadLog(const std::string& path, MapperNode* node) {
  LogReader log(path);
  LogRead read;
  while (const auto event = log.Next()) {
    ++read.events;
    if (event->channel == "CLOUD") ++read.sweeps;
    if (event->channel != "RGBDT_CLOUD") continue;
    try {
      const Message message = Decode(event->channel, event->bytes.data(), event->bytes.size());
      node->Handle(message);
      AddPose(message, &read.way);
      ++read.clouds;
    } catch (const std::exception& e) {
      ++read.dropped;
      read.last_problem = e.what();
    }
  }
  read.unreadable_bytes = log.unreadable_bytes();
  return read;
}

// Of a LogRead, or a MappedDrive.
template <typename Read>
void TellDropped(const std::string& log, const Read& read) {
  if (read.unreadable_bytes > 0) {
    std::fprintf(stderr, "%s: %lld bytes belong to no whole message; was the logger killed?\n",
                 log.c_str(), static_cast<long long>(read.unreadable_bytes));
  }
  if (read.dropped > 0) {
    std::fprintf(stderr, "%s: %lld messages dropped; last problem: %s\n", log.c_str(),
                 static_cast<long long>(read.dropped), read.last_problem.c_str());
  }
}

std::vector<Eigen::Vector3d> PlacesOf(const std::vector<StampedPose>& way) {
  std::vector<Eigen::Vector3d> places(way.size());
  std::transform(way.begin(), way.end(), places.begin(),
                 [](const StampedPose& pose) { return pose.map_from_lidar.translation; });
  return places;
}

double LengthOf(const std::vector<Eigen::Vector3d>& places) {
  double length = 0;
  for (std::size_t i = 1; i < places.size(); ++i) length += (places[i] - places[i - 1]).norm();
  return length;
}

std::filesystem::path Beside(const std::filesystem::path& map, const std::string& end) {
  return map.parent_path() / (map.stem().string() + end);
}

// Where there is none, as a map is too wide for it, the map is there all the same.
std::optional<Terrain> TerrainOf(const MapCloud& map, const TerrainOptions& limits) {
  try {
    return FindTerrain(map, limits);
  } catch (const InputError& e) {
    std::fprintf(stderr, "no terrain: %s\n", e.what());
    return std::nullopt;
  }
}

// What an earlier map of this name had beside it.
void RemoveSideFiles(const std::filesystem::path& map) {
  std::error_code ignored;
  for (const char* end : {".tum", ".png", "_terrain.png", "_terrain.json"}) {
    std::filesystem::remove(Beside(map, end), ignored);
  }
}

// The map, and beside it the way, a picture from above and the terrain.
void WriteMap(const MapFlags& flags, const MapperNode& node, std::int64_t clouds,
              const std::vector<StampedPose>& way, const std::vector<Eigen::Vector3d>& loops,
              std::FILE* told) {
  const MapCloud map = node.map().Cloud();
  WriteMapPly(flags.out, map);
  RemoveSideFiles(flags.out);
  std::fprintf(
      told, "%lld clouds, %lld points in %zu voxels of %g m, frame %s; wrote %s\n",
      static_cast<long long>(clouds), static_cast<long long>(node.map().points()), map.size(),
      map.voxel_m,
      map.frame == "map" ? "of the pose stream" : "LIDAR (no poses: a rig that stands still)",
      flags.out.c_str());
  if (node.map().evicted() > 0) {
    std::fprintf(told, "the map was full: %lld voxels went; take larger ones, or --max-voxels\n",
                 static_cast<long long>(node.map().evicted()));
  }
  std::string wrote;
  if (!way.empty()) {
    const std::filesystem::path tum = Beside(flags.out, ".tum");
    WriteFileAtomically(tum, TumText(way));
    wrote = tum.string() + " (the way, in TUM's format), ";
  }
  const std::filesystem::path picture = Beside(flags.out, ".png");
  WritePng(picture, MapPicture(map, PlacesOf(way), loops));
  wrote += picture.string() + " (from above)";
  const std::filesystem::path terrain = Beside(flags.out, "_terrain.png");
  const TerrainOptions limits;
  if (const auto found = TerrainOf(map, limits)) {
    WriteTerrain(*found, limits, map.frame, flags.out, Beside(flags.out, "_terrain.json"), terrain,
                 told);
    wrote += ", " + terrain.string() + " and .json (where a vehicle can drive)";
  }
  std::fprintf(told, "wrote %s\n", wrote.c_str());
}

void TellNext(const MapFlags& flags) {
  std::printf("next: for the limits of your vehicle: rgbdt terrain %s --max-slope ... --out DIR\n",
              ForShell(flags.out).c_str());
}

void TellRefused(const ClosedWay& closed, std::FILE* told) {
  if (closed.refused() == 0) return;
  std::fprintf(
      told,
      "%zu of %zu places that look alike, or lie near each other, were refused: %zu where the "
      "sweep "
      "does not lie on what was seen before, %zu farther off than odometry can be, %zu that no "
      "others nearby bear out, %zu that contradict the rest\n",
      closed.refused(), closed.tried, closed.do_not_fit, closed.against_odometry, closed.alone,
      closed.contradict);
}

// What cameras had to say of the loops.
void TellColours(const ClosedWay& closed, std::FILE* told) {
  std::size_t seen = 0, unlike = 0;
  for (const ClosedLoop& loop : closed.loops) {
    if (loop.colours.cells > 0) ++seen;
    if (loop.sigma_factor > 3) ++unlike;
  }
  if (seen == 0) return;
  std::fprintf(told, "cameras saw both places of %zu of them: ", seen);
  if (unlike == 0) {
    std::fprintf(told, "they look the same\n");
  } else {
    std::fprintf(told, "%zu look different and hardly count (another light, or another place)\n",
                 unlike);
  }
}

void TellLoops(const ClosedWay& closed, std::FILE* told) {
  if (!closed.solved) {
    std::fprintf(told, "loops: the poses have no solution; the way is as odometry found it\n");
  } else if (closed.loops.empty()) {
    std::fprintf(
        told,
        "no loop found: way and map are as without --close-loops, which takes a way back to a "
        "place after %g m or more\n",
        LoopClosureOptions().least_way_m);
  } else {
    std::fprintf(
        told, "%zu loops closed: the end of the way moved by %.2f m, no place by more than %.2f\n",
        closed.loops.size(), closed.end_moved_m, closed.most_moved_m);
    TellColours(closed, told);
  }
  TellRefused(closed, told);
}

void TellDrive(const MappedDrive& drive, std::FILE* told) {
  const std::vector<Eigen::Vector3d> places = PlacesOf(drive.way);
  const double way = LengthOf(places);
  std::fprintf(told, "%.1f m of way, %zu poses by %s\n", way, drive.way.size(),
               drive.by_odometry ? "odometry from the sweeps" : "the log's POSE");
  if (!drive.by_odometry) return;
  std::fprintf(told, "%lld sweeps, %lld without a place, %lld that do not tell a direction\n",
               static_cast<long long>(drive.sweeps), static_cast<long long>(drive.without_place),
               static_cast<long long>(drive.degenerate));
  if (drive.degenerate > 0) {
    std::fprintf(told, "where a direction is not told, as along a corridor, the way is a guess\n");
  }
  if (drive.restarts > 0) {
    std::fprintf(told, "the map was begun anew %lld times: parts of it may lie off each other\n",
                 static_cast<long long>(drive.restarts));
  }
  if (drive.closed) {
    TellLoops(*drive.closed, told);
  } else if (ComesBack(places)) {
    std::fprintf(told,
                 "the way comes back to where it was: --close-loops corrects what it drifted by in "
                 "between\n");
  }
}

// Where the way came back to a place.
std::vector<Eigen::Vector3d> PlacesOfLoops(const MappedDrive& drive) {
  std::vector<Eigen::Vector3d> places;
  if (!drive.closed) return places;
  const ClosedWay& closed = *drive.closed;
  for (const ClosedLoop& loop : closed.loops) {
    const auto at = std::lower_bound(closed.utimes.begin(), closed.utimes.end(), loop.new_utime);
    places.push_back(
        closed.after[static_cast<std::size_t>(at - closed.utimes.begin())].translation);
  }
  return places;
}

std::string Number(std::int64_t value) { return std::to_string(value); }

// How the way was found; what only odometry tells is null where the log's POSE did.
std::string DriveJson(const MappedDrive& drive) {
  const auto of_odometry = [&](std::int64_t value) {
    return drive.by_odometry ? Number(value) : "null";
  };
  std::string text = "{\"length_m\": " + Fixed(LengthOf(PlacesOf(drive.way)), 3) +
                     ", \"poses\": " + std::to_string(drive.way.size()) +
                     ", \"by_odometry\": " + (drive.by_odometry ? "true" : "false") +
                     ", \"sweeps\": " + of_odometry(drive.sweeps) +
                     ", \"without_place\": " + of_odometry(drive.without_place) +
                     ", \"degenerate\": " + of_odometry(drive.degenerate) +
                     ", \"begun_anew\": " + of_odometry(drive.restarts);
  text += ", \"loops\": " + (drive.closed ? std::to_string(drive.closed->loops.size()) : "null");
  return text + "}";
}

// `read`: a LogRead, or a MappedDrive.
template <typename Read>
void PrintJson(const MapperNode& node, const Read& read, const std::string& drive) {
  std::printf(
      "{\n  \"clouds\": %s,\n  \"points\": %s,\n  \"voxels\": %zu,\n  \"voxels_gone\": %s,\n"
      "  \"frame\": \"%s\",\n  \"messages_dropped\": %s,\n  \"unreadable_bytes\": %s,\n"
      "  \"drive\": %s\n}\n",
      Number(read.clouds).c_str(), Number(node.map().points()).c_str(), node.map().size(),
      Number(node.map().evicted()).c_str(), node.map().frame().value_or("").c_str(),
      Number(read.dropped).c_str(), Number(read.unreadable_bytes).c_str(), drive.c_str());
}

int RunDrive(const MapFlags& flags) {
  MapperNode node(flags.options);
  DriveOptions options;
  options.close_loops = flags.close_loops;
  const MappedDrive drive = MapDrive(flags.log, &node, options);
  TellDropped(flags.log, drive);
  if (node.map().size() == 0) {
    throw InputError(flags.log + ": its poses and its sweeps (CLOUD) are of different times");
  }
  std::FILE* told = flags.json ? stderr : stdout;
  WriteMap(flags, node, drive.clouds, drive.way, PlacesOfLoops(drive), told);
  TellDrive(drive, told);
  if (flags.json) PrintJson(node, drive, DriveJson(drive));
  if (!flags.json) TellNext(flags);
  return EndsWith(true);
}

// What is written beside the map would take its place.
void RequireNameOfMap(const std::filesystem::path& map) {
  for (const char* end : {".tum", ".png"}) {
    if (map.extension() != end) continue;
    throw InputError("--out " + map.string() + ": the map is a PLY file, and what ends in " + end +
                     " is written beside it; expected a name that ends in .ply");
  }
}

int RunMap(const MapFlags& flags) {
  flags.options.Check();
  RequireNameOfMap(flags.out);
  CheckWritable(flags.out);
  if (flags.drive || flags.close_loops) return RunDrive(flags);
  MapperNode node(flags.options);
  const LogRead read = ReadLog(flags.log, &node);
  if (read.clouds == 0 && read.sweeps > 0) return RunDrive(flags);
  TellDropped(flags.log, read);
  if (node.map().size() == 0) {
    throw InputError(flags.log + ": none of its " + std::to_string(read.events) +
                     " messages is a fused cloud with points (RGBDT_CLOUD), or a sweep (CLOUD); "
                     "record either channel, as rgbdt-fuser or the LIDAR publishes it");
  }
  WriteMap(flags, node, read.clouds, read.way, {}, flags.json ? stderr : stdout);
  if (flags.json) PrintJson(node, read, "null");
  if (!flags.json) TellNext(flags);
  return EndsWith(true);
}

}  // namespace

void AddMap(CommandLine* program) {
  auto flags = std::make_shared<MapFlags>();
  CommandLine* verb = program->Verb(
      "map",
      "Fused clouds of a log (RGBDT_CLOUD) to a map of voxels, in the pose stream's frame: mean\n"
      "place, colour, temperature [K], count, last seen. rgbdt-mapper does it live. Beside the "
      "map\n"
      "are written the way where poses tell it (.tum), a picture from above (.png) and where a "
      "vehicle can drive\n"
      "(_terrain.png and .json, as rgbdt terrain finds it). A log that has sweeps (CLOUD) and no\n"
      "fused clouds is a drive: its way comes from POSE or else from the sweeps themselves, as\n"
      "rgbdt-odometry finds it. With --close-loops the way is corrected where it came back to a\n"
      "place, and so is all that is made of it.\n"
      "Example: rgbdt map session.lcmlog --voxel 0.1 --out out/map.ply",
      [flags] { return RunMap(*flags); });
  verb->Required("LOG", &flags->log, "log written by lcm-logger");
  verb->Option("--out", &flags->out, "the map, a PLY file");
  verb->Flag(
      "--drive", &flags->drive,
      "as a drive, from CLOUD, though the log has fused clouds: of a rig that moved and was\n"
      "fused without POSE");
  verb->Flag(
      "--close-loops", &flags->close_loops,
      "as a drive whose way is found from the sweeps (POSE is left aside); where it comes back to "
      "a\n"
      "place it is corrected for what it drifted by, and the map made with that. Off by default:\n"
      "the way is then that of rgbdt-odometry, live, and a loop that is no loop cannot bend it");
  verb->Flag(
      "--json", &flags->json,
      "for programs: print what came of it as JSON on stdout (with `drive`: how the way was\n"
      "found), and nothing else there; words go to stderr");
  verb->Option("--voxel", &flags->options.voxel_m, "edge of a voxel [m]");
  verb->Option("--max-voxels", &flags->options.max_voxels,
               "most voxels kept (80 bytes each); then those not seen for the longest are dropped");
}

}  // namespace rgbdt
