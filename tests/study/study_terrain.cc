// How much of the ground is judged, and rightly: sweeps of synthetic scenes against the truth.
// Usage: study_terrain SCENE FIRST_SEED SEEDS OUT.csv
// SCENE: course, outdoor, indoor, night. A line a sweep: turned scanner and 64 rings, range noise
// of 10 and 30 mm.
#include <fstream>
#include <map>
#include <stdexcept>

#include "tests/study/study_main.h"
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

void Run(const std::string& scene, std::uint64_t first, std::uint64_t seeds,
         const std::string& path) {
  const auto found = kScenes.find(scene);
  if (found == kScenes.end()) {
    throw std::runtime_error("SCENE is " + scene + "; there are: course, outdoor, indoor, night");
  }
  const TerrainOptions options;
  std::ofstream csv(path);
  csv << "scene,seed,range_sigma_mm,known,right,missed,invented,seen,seen_known,sites,"
         "sites_on_obstacle\n";
  for (std::uint64_t seed = first; seed < first + seeds; ++seed) {
    for (const int rings : {0, 64}) {
      for (const double sigma : {0.01, 0.03}) {
        const TerrainCase which{found->second, seed, sigma, rings};
        const TerrainWorld world(which);
        Write(which, Score(world, FindTerrain(world.cloud(), options), options), &csv);
      }
    }
  }
  if (!csv.flush()) throw std::runtime_error("cannot write " + path);
}

}  // namespace
}  // namespace rgbdt::study

int main(int argc, char** argv) {
  const auto run = [](const std::vector<std::string>& arguments) {
    rgbdt::study::Run(arguments[0], std::stoull(arguments[1]), std::stoull(arguments[2]),
                      arguments[3]);
  };
  return rgbdt::study::StudyMain(
      {"study_terrain", "course|outdoor|indoor|night FIRST_SEED SEEDS CSV", 4, 4, run}, argc, argv);
}
