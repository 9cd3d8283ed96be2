#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include "calib/files/atomic_file.h"
#include "calib/files/check_writable.h"
#include "calib/files/image_files.h"
#include "calib/files/points/map_files.h"
#include "calib/model/text.h"
#include "calib/present/pictures/terrain_json.h"
#include "calib/present/pictures/terrain_picture.h"
#include "calib/terrain/terrain.h"
#include "services/rgbdt/verbs.h"
#include "services/rgbdt/write_terrain.h"

namespace rgbdt {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;

struct TerrainFlags {
  std::string input, out = "out/terrain";
  TerrainOptions options;
  bool json = false;
  double max_slope_deg = 20, site_max_slope_deg = 15;
};

void PrintSites(const std::vector<LandingSite>& sites) {
  if (sites.empty()) {
    std::printf("no landing site: nowhere is a disc of that radius flat, seen all over and free\n");
    return;
  }
  std::printf(
      "site      x m      y m      z m  radius m  slope deg  rough mm  clear m  temp C  score\n");
  for (std::size_t i = 0; i < sites.size(); ++i) {
    const LandingSite& site = sites[i];
    const auto number = [](double value, const char* format) {
      return std::isfinite(value) ? Format(format, value) : "-";
    };
    std::printf("%4zu %8.2f %8.2f %8.2f %9.2f %10.1f %9.0f %8s %7s %6.2f\n", i + 1, site.centre.x(),
                site.centre.y(), site.centre.z(), site.radius_m, site.slope_rad / kDegree,
                1000 * site.roughness_m, number(site.clearance_m, "%.2f").c_str(),
                number(site.temperature_k - 273.15, "%.1f").c_str(), site.score);
  }
}

int RunTerrain(TerrainFlags flags) {
  flags.options.max_slope_rad = flags.max_slope_deg * kDegree;
  flags.options.site_max_slope_rad = flags.site_max_slope_deg * kDegree;
  flags.options.Check();
  const std::filesystem::path out = flags.out;
  CheckWritable(out / "terrain.json");
  const MapCloud cloud = ReadMapOrCloud(flags.input);
  const Terrain terrain = FindTerrain(cloud, flags.options);
  WriteTerrain(terrain, flags.options, cloud.frame, flags.input, out / "terrain.json",
               out / "terrain.png", flags.json ? stderr : stdout);
  if (flags.json) {
    std::fputs(ReadWholeFile(out / "terrain.json").c_str(), stdout);
    return EndsWith(true);
  }
  PrintSites(terrain.sites);
  std::printf("wrote terrain.json, terrain.png to %s; look at terrain.png\n", flags.out.c_str());
  return EndsWith(true);
}

void AddLimits(TerrainFlags* flags, CommandLine* verb) {
  TerrainOptions& options = flags->options;
  verb->Option("--cell", &options.cell_m, "edge of a cell [m]");
  verb->Option("--max-slope", &flags->max_slope_deg,
               "steepest slope that the vehicle climbs [degrees]");
  verb->Option("--max-step", &options.max_step_m, "highest step that it crosses [m]");
  verb->Option("--max-roughness", &options.max_roughness_m,
               "highest RMS roughness that it crosses [m]");
  verb->Option("--vehicle-width", &options.vehicle_width_m, "narrowest gap that it passes [m]");
  verb->Option("--vehicle-height", &options.vehicle_height_m,
               "lowest clearance that it passes under [m]");
  verb->Option("--site-radius", &options.site_radius_m, "least radius of a landing site [m]");
  verb->Option("--site-slope", &flags->site_max_slope_deg,
               "steepest slope of a landing site [degrees]");
  verb->Option("--headroom", &options.site_headroom_m, "free height above a landing site [m]");
}

}  // namespace

void WriteTerrain(const Terrain& terrain, const TerrainOptions& options, const std::string& frame,
                  const std::string& input, const std::filesystem::path& json,
                  const std::filesystem::path& picture, std::FILE* told) {
  WriteFileAtomically(json, TerrainJson(terrain, options, frame, input));
  WritePng(picture, TerrainPicture(terrain, options, frame));
  const std::vector<CellState>& state = terrain.grid.state;
  const auto count = [&](CellState one) {
    return static_cast<long long>(std::count(state.begin(), state.end(), one));
  };
  std::fprintf(
      told,
      "%d x %d cells of %g m, frame %s: %lld traversable, %lld obstacle, the others unknown\n",
      terrain.grid.columns, terrain.grid.rows, terrain.grid.cell_m, frame.c_str(),
      count(CellState::kTraversable), count(CellState::kObstacle));
}

void AddTerrain(CommandLine* program) {
  auto flags = std::make_shared<TerrainFlags>();
  CommandLine* verb = program->Verb(
      "terrain",
      "Where can a vehicle drive, and where land? From a map (rgbdt map) or one fused cloud "
      "(rgbdt\n"
      "fuse), any PLY or PCD with z up: slope, roughness, step and temperature of each cell,\n"
      "landing sites ranked. Writes terrain.json and terrain.png.\n"
      "Example: rgbdt terrain out/demo/fused.ply --out out/terrain --cell 0.2",
      [flags] { return RunTerrain(*flags); });
  verb->Required("INPUT", &flags->input, "PLY or PCD file");
  verb->Option("--out", &flags->out, "where to write");
  verb->Flag("--json", &flags->json,
             "for programs: print terrain.json on stdout, and nothing else there");
  AddLimits(flags.get(), verb);
}

}  // namespace rgbdt
