// The estimate against the truth of rendered scenes: 95% of the judged cells right, no landing site
// on an obstacle. scripts/study terrain tells it over more seeds.
#include <algorithm>
#include <cmath>

#include "tests/study/terrain_scenes.h"
#include "tests/unit/matchers.h"

namespace rgbdt::study {
namespace {

class TerrainTruth : public ::testing::TestWithParam<TerrainCase> {};

TEST_P(TerrainTruth, IsFound) {
  const TerrainOptions options;
  const TerrainWorld world(GetParam());
  const TerrainScore score = Score(world, FindTerrain(world.cloud(), options), options);
  RecordProperty("terrain_cells_right", std::to_string(score.right_share()));
  RecordProperty("terrain_cells_known", std::to_string(score.known_share()));
  RecordProperty("terrain_sites_on_obstacle", score.sites_on_obstacle);
  EXPECT_GT(score.known, 900);
  EXPECT_GE(score.right_share(), 0.95)
      << score.missed << " missed, " << score.invented << " invented of " << score.known;
  EXPECT_GE(score.known_share(), 0.75) << score.seen_known << " of " << score.seen;
  EXPECT_EQ(score.sites_on_obstacle, 0) << "of " << score.sites;
}

std::string Label(const testing::TestParamInfo<TerrainCase>& info) {
  std::string name = NameOf(info.param) + "_seed" + std::to_string(info.param.seed);
  std::replace(name.begin(), name.end(), ':', '_');
  return name + "_" + std::to_string(std::lround(1000 * info.param.range_sigma_m)) + "mm";
}

INSTANTIATE_TEST_SUITE_P(Scenes, TerrainTruth,
                         testing::Values(TerrainCase{TerrainScene::kCourse, 301, 0.01, 0},
                                         TerrainCase{TerrainScene::kCourse, 302, 0.03, 0},
                                         TerrainCase{TerrainScene::kCourse, 303, 0.02, 64},
                                         TerrainCase{TerrainScene::kOutdoor, 304, 0.01, 0},
                                         TerrainCase{TerrainScene::kIndoor, 305, 0.01, 64},
                                         TerrainCase{TerrainScene::kNight, 306, 0.02, 0}),
                         Label);

}  // namespace
}  // namespace rgbdt::study
