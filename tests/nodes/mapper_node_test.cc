#include "services/nodes/mapper_node.h"

#include <filesystem>
#include <limits>

#include "tests/nodes/nodes_testing.h"
#include "tests/numbers.h"
#include "tests/unit/files/test_data.h"
#include "tests/unit/matchers.h"

namespace rgbdt {
namespace {

using test::Counter;

using ::testing::HasSubstr;

RgbdtCloud FusedChunk(float x, Utime utime = kNow) {
  RgbdtCloud cloud;
  cloud.sweep_utime = kNow;
  cloud.points = {{x, 0.01F, 0.01F}, {x, 0.02F, 0.02F}};
  cloud.intensity = {0.5F, 0.5F};
  cloud.utime = {utime, utime};
  cloud.rgb = {{{10, 20, 30}, {0, 0, 0}}};
  cloud.temperature_k = {300, std::numeric_limits<float>::quiet_NaN()};
  cloud.thermal_counts = cloud.temperature_k;
  cloud.valid = {0, 0};
  return cloud;
}

MapperNode NewMapper() {
  VoxelMapOptions options;
  options.voxel_m = 0.1;
  return MapperNode(options);
}

TEST(MapperNode, MapsChunksAndSaysNothing) {
  MapperNode node = NewMapper();
  EXPECT_THAT(node.GetStatus().text, HasSubstr("RGBDT_CLOUD"));
  EXPECT_TRUE(node.Handle(FusedChunk(1.05F)).empty());
  EXPECT_TRUE(node.Handle(FusedChunk(2.05F)).empty());
  EXPECT_EQ(node.map().size(), 2U);
  EXPECT_THAT(node.GetStatus().text, HasSubstr("LIDAR frame"));
  EXPECT_EQ(Counter(node.GetStatus(), "clouds"), 2);
  EXPECT_EQ(Counter(node.GetStatus(), "points"), 4);
  EXPECT_EQ(Counter(node.GetStatus(), "voxels"), 2);
}

TEST(MapperNode, WithTheFirstPoseItBeginsAnew) {
  MapperNode node = NewMapper();
  node.Handle(FusedChunk(1.05F));
  RgbdtCloud posed = FusedChunk(2.05F);
  posed.map_from_lidar = Rigid3();
  posed.frame_utime = kNow;
  node.Handle(posed);
  EXPECT_EQ(node.map().size(), 1U);
  EXPECT_EQ(node.map().points(), 2);
  EXPECT_THAT(node.GetStatus().text, HasSubstr("pose stream"));
}

TEST(MapperNode, APoseThatIsMissingIsRefusedAndTheMapStays) {
  MapperNode node = NewMapper();
  RgbdtCloud posed = FusedChunk(1.05F);
  posed.map_from_lidar = Rigid3();
  posed.frame_utime = kNow;
  node.Handle(posed);
  EXPECT_THAT(InputErrorOf([&] { node.Handle(FusedChunk(2.05F)); }), HasSubstr("pose"));
  EXPECT_EQ(node.map().size(), 1U);
  EXPECT_THAT(node.GetStatus().text, HasSubstr("pose stream"));
}

TEST(MapperNode, SavesAMapThatHasChangedAndNotTooOften) {
  const test::TempDir dir;
  VoxelMapOptions options;
  MapperNode node(options, dir / "map.ply", 5 * kMicrosecondsPerSecond);
  const auto saved_at = [&](Utime seconds) {
    std::filesystem::remove(dir / "map.ply");
    node.Advance(seconds * kMicrosecondsPerSecond);
    return std::filesystem::exists(dir / "map.ply");
  };
  EXPECT_FALSE(saved_at(0)) << "a map without points";
  node.Handle(FusedChunk(1));
  EXPECT_TRUE(saved_at(1));
  node.Handle(FusedChunk(2));
  EXPECT_FALSE(saved_at(3)) << "it took two seconds";
  EXPECT_FALSE(saved_at(22));
  EXPECT_TRUE(saved_at(23));
  EXPECT_FALSE(saved_at(1000)) << "nothing has changed";
  node.Handle(FusedChunk(3));
  node.Save();
  EXPECT_TRUE(std::filesystem::exists(dir / "map.ply"));
}

TEST(MapperNode, AMapThatCannotBeSavedIsAWarningAndIsTriedAgain) {
  const test::TempDir dir;
  test::WriteQuickly(dir / "file", "");
  MapperNode node(VoxelMapOptions(), dir / "file" / "map.ply", kMicrosecondsPerSecond);
  std::vector<std::string> warnings;
  node.SetWarningHandler([&](const std::string& warning) { warnings.push_back(warning); });
  node.Handle(FusedChunk(1));
  for (const Utime now : {0, 1, 2'000'000}) node.Advance(now);
  ASSERT_EQ(warnings.size(), 2U);
  EXPECT_THAT(warnings[1], HasSubstr("cannot create the folder " + (dir / "file").string()));
  EXPECT_NE(InputErrorOf([&] { node.Save(); }), "");
}

}  // namespace
}  // namespace rgbdt
