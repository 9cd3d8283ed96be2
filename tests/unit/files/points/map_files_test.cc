#include "calib/files/points/map_files.h"

#include "calib/files/atomic_file.h"
#include "calib/files/points/cloud_files.h"
#include "tests/unit/files/test_data.h"

namespace rgbdt {
namespace {

using test::ErrorOf;
using test::kNan;
using test::kNow;
using test::MakeMap;
using test::TempDir;
using ::testing::HasSubstr;

std::string AsciiPly(const std::string& properties, const std::string& data,
                     const std::string& count = "2") {
  return "ply\r\nformat ascii 1.0\r\nelement vertex " + count + "\n" + properties +
         "element face 1\nproperty list uchar int vertex_indices\nend_header\n" + data;
}

TEST(MapFiles, ReadsBackWhatItWrote) {
  const TempDir dir;
  const MapCloud map = MakeMap();
  WriteMapPly(dir / "map.ply", map);
  const MapCloud back = ReadMapPly(dir / "map.ply");
  EXPECT_EQ(back.points, map.points);
  EXPECT_EQ(back.rgb, map.rgb);
  EXPECT_EQ(back.temperature_k[0], map.temperature_k[0]);
  EXPECT_TRUE(std::isnan(back.temperature_k[1]));
  EXPECT_EQ(back.count, map.count);
  EXPECT_EQ(back.last_seen, map.last_seen);
  EXPECT_EQ(back.frame, "map");
  EXPECT_EQ(back.voxel_m, 0.1);
}

TEST(MapFiles, AFramesNameIsAWordThatMovesNoCursor) {
  const TempDir dir;
  WriteMapPly(dir / "map.ply", MakeMap());
  std::string bytes = ReadWholeFile(dir / "map.ply");
  const std::string frame = "frame: map";
  bytes.replace(bytes.find(frame), frame.size(), "frame: \x1b[2J");
  EXPECT_EQ(ParseMapPly(bytes, "m.ply").frame, "__2J");
}

TEST(MapFiles, ABadMapIsNotWritten) {
  const TempDir dir;
  EXPECT_THAT(ErrorOf([&] { WriteMapPly(dir / "map.ply", {}); }), HasSubstr("empty"));
  MapCloud map = MakeMap();
  map.count.pop_back();
  EXPECT_THAT(ErrorOf([&] { WriteMapPly(dir / "map.ply", map); }), HasSubstr("2 points but 1"));
  EXPECT_FALSE(std::filesystem::exists(dir / "map.ply"));
}

TEST(MapFiles, CutShortAnywhereItIsRefused) {
  const TempDir dir;
  WriteMapPly(dir / "map.ply", MakeMap());
  const std::string bytes = ReadWholeFile(dir / "map.ply");
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_THAT(ErrorOf([&] { ParseMapPly(bytes.substr(0, size), "m.ply"); }), HasSubstr("m.ply"));
  }
}

// Any byte may be wrong: an error or a map, never anything else.
TEST(MapFiles, DamagedAnywhereItIsReadOrRefused) {
  const TempDir dir;
  WriteMapPly(dir / "map.ply", MakeMap());
  const std::string bytes = ReadWholeFile(dir / "map.ply");
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    for (const char wrong : {'\0', '9', '\xff', '\n', ' '}) {
      std::string damaged = bytes;
      damaged[at] = wrong;
      try {
        EXPECT_LE(ParseMapPly(damaged, "m.ply").size(), 2U);
      } catch (const InputError&) {
      }
    }
  }
}

TEST(MapFiles, ReadsOtherPlyFiles) {
  const TempDir dir;
  const std::string path = dir / "other.ply";
  test::WriteQuickly(path, AsciiPly("property double z\nproperty float x\nproperty uchar quality\n"
                                    "property float y\n",
                                    "3 1 200 2\nnan 1 1 1\n3 0 1 2\n"));
  const MapCloud cloud = ReadMapOrCloud(path);
  ASSERT_EQ(cloud.size(), 1U) << "a point that is not finite is left out";
  EXPECT_EQ(cloud.points[0], Eigen::Vector3f(1, 2, 3));
  EXPECT_EQ(cloud.count[0], 1U);
  EXPECT_EQ(cloud.voxel_m, 0);
  EXPECT_EQ(cloud.frame, "lidar");
  EXPECT_THAT(ErrorOf([&] { ReadMapPly(path); }), HasSubstr("not a map"));
}

TEST(MapFiles, ReadsFusedClouds) {
  const TempDir dir;
  RgbdtCloud fused;
  fused.cameras = {"rgb"};
  fused.calibration_utime = {kNow};
  fused.points = {{1, 2, 3}, {4, 5, 6}};
  fused.intensity = {0.5F, 0.5F};
  fused.utime = {kNow, kNow};
  fused.rgb = {{{1, 2, 3}, {4, 5, 6}}};
  fused.temperature_k = {301, kNan};
  fused.temperature_sigma_k = {0.05F, kNan};
  fused.thermal_counts = {kNan, kNan};
  fused.valid = {1, 1};
  WritePly(dir / "fused.ply", fused);
  WritePcd(dir / "fused.pcd", fused);
  for (const char* name : {"fused.ply", "fused.pcd"}) {
    const MapCloud cloud = ReadMapOrCloud(dir / name);
    EXPECT_EQ(cloud.points, fused.points) << name;
    EXPECT_EQ(cloud.temperature_k[0], 301) << name;
    EXPECT_TRUE(std::isnan(cloud.temperature_k[1])) << name;
  }
}

}  // namespace
}  // namespace rgbdt
