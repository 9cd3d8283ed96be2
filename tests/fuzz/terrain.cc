// A map, or any cloud, in which `rgbdt terrain` finds where a vehicle can drive.
#include "calib/terrain/terrain.h"

#include "calib/files/points/map_files.h"
#include "calib/present/pictures/terrain_json.h"
#include "calib/present/pictures/terrain_picture.h"
#include "tests/fuzz/fuzz.h"

namespace rgbdt {
namespace {

void CheckGrid(const Terrain& terrain, const TerrainOptions& options) {
  const TerrainGrid& grid = terrain.grid;
  fuzz::Require(grid.columns > 0 && grid.rows > 0 && grid.size() <= options.max_cells,
                "a grid of some cells, and no more than may be");
  for (const std::size_t other : {grid.height_m.size(), grid.points.size(), grid.step_m.size()}) {
    fuzz::Require(other == grid.size(), "a value for each cell");
  }
}

}  // namespace
}  // namespace rgbdt

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rgbdt;
  static const fuzz::ScratchFile file("map.ply");
  file.Write(fuzz::Input(data, size).Rest());
  TerrainOptions options;
  options.max_cells = 5000;
  fuzz::Try([&] {
    const MapCloud cloud = ReadMapOrCloud(file.path());
    const Terrain terrain = FindTerrain(cloud, options);
    CheckGrid(terrain, options);
    TerrainJson(terrain, options, cloud.frame, "map.ply");
    TerrainPicture(terrain, options, cloud.frame);
  });
  return 0;
}
