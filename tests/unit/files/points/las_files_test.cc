#include "calib/files/points/las_files.h"

#include "calib/files/atomic_file.h"
#include "calib/files/points/internal/las_layout.h"
#include "tests/unit/files/test_data.h"

namespace rgbdt {
namespace {

using test::ErrorOf;
using test::kNan;
using test::TempDir;
using ::testing::HasSubstr;

MapCloud SmallMap() {
  MapCloud map;
  map.voxel_m = 0.1;
  map.points = {{1.25F, -2.5F, 0.1F}, {1e4F, 0, -3}};
  map.rgb = {{{1, 128, 255}, {0, 0, 0}}};
  map.temperature_k = {300.25F, kNan};
  map.count = {7, 4'000'000'000U};
  map.last_seen = {1'600'000'000'000'000, 0};
  return map;
}

// What the files hold, tests/cli/read_las.py reads.
TEST(LasFiles, ABadCloudIsNotWritten) {
  const TempDir dir;
  EXPECT_THAT(ErrorOf([&] { WriteLas(dir / "a.las", MapCloud{}); }), HasSubstr("no points"));
  MapCloud map = SmallMap();
  map.count.pop_back();
  EXPECT_THAT(ErrorOf([&] { WriteLas(dir / "a.las", map); }), HasSubstr("2 points but 1"));
  for (const float wrong : {kNan, 2.2e5F, -2.2e5F}) {
    map = SmallMap();
    map.points[1].z() = wrong;
    EXPECT_THAT(ErrorOf([&] { WriteLas(dir / "a.las", map); }), HasSubstr("214748")) << wrong;
  }
  EXPECT_FALSE(std::filesystem::exists(dir / "a.las"));
  WriteLas(dir / "a.las", SmallMap());
  EXPECT_EQ(ReadWholeFile(dir / "a.las").substr(0, 4), "LASF");
}

// Of the last leap second so far, when GPS counted 1930 weeks and 18 s.
TEST(LasFiles, LeapSecondsArePutIn) {
  constexpr Utime turn = 1'483'228'800'000'000;  // 1 January 2017
  EXPECT_EQ(las::GpsTime(turn - 1'000'000), 1167264016.0 - 1e9);
  EXPECT_EQ(las::GpsTime(turn), 1167264018.0 - 1e9);
  EXPECT_EQ(las::GpsTime(315'964'800'000'000), -1e9);  // 6 January 1980
}

}  // namespace
}  // namespace rgbdt
