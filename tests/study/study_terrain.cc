// How much of the ground is judged, and rightly: sweeps of synthetic scenes against the truth.
// Usage: study_terrain SCENE FIRST_SEED SEEDS OUT.csv
// SCENE: course, outdoor, indoor, night. A line a sweep: turned scanner and 64 rings, range noise
// of 10 and 30 mm.
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>

#include "tests/study/terrain_scenes.h"

namespace rgbdt::study {
namespace {

const std::map<std::string, TerrainScene> kScenes = {{"course", TerrainScene::kCourse},
                                                     {"outdoor", TerrainScene::kOutdoor},
                                                     {"indoor", TerrainScene::kIndoor},
                                                     {"night", TerrainScene::kNight}};

void Write(const TerrainCase& which, const TerrainScore& score, std::ostream* csv) {
  *csv << NameOf(which) << ',' << which.seed << ',' << 1000 * which.range_sigma_m << ','
       << score.known << ',' << score.right << ',' << score.missed << ',' << score.invented << ','
       << score.seen << ',' << score.seen_known << ',' << score.sites << ','
       << score.sites_on_obstacle << '\n';
}

void Run(TerrainScene scene, std::uint64_t first, std::uint64_t seeds, std::ostream* csv) {
  const TerrainOptions options;
  *csv << "scene,seed,range_sigma_mm,known,right,missed,invented,seen,seen_known,sites,"
          "sites_on_obstacle\n";
  for (std::uint64_t seed = first; seed < first + seeds; ++seed) {
    for (const int rings : {0, 64}) {
      for (const double sigma : {0.01, 0.03}) {
        const TerrainCase which{scene, seed, sigma, rings};
        const TerrainWorld world(which);
        Write(which, Score(world, FindTerrain(world.cloud(), options), options), csv);
      }
    }
  }
}

}  // namespace
}  // namespace rgbdt::study

int main(int argc, char** argv) {
  const auto scene = argc == 5 ? rgbdt::study::kScenes.find(argv[1]) : rgbdt::study::kScenes.end();
  if (scene == rgbdt::study::kScenes.end()) {
    std::fprintf(stderr,
                 "usage: study_terrain course|outdoor|indoor|night FIRST_SEED SEEDS OUT.csv\n");
    return 1;
  }
  std::ofstream csv(argv[4]);
  rgbdt::study::Run(scene->second, std::strtoull(argv[2], nullptr, 10),
                    std::strtoull(argv[3], nullptr, 10), &csv);
  csv.close();
  return csv ? 0 : 1;
}
