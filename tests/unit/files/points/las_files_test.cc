#include "calib/files/points/las_files.h"

#include "calib/files/atomic_file.h"
#include "calib/files/points/internal/las_layout.h"
#include "tests/unit/files/test_data.h"

namespace rgbdt {
namespace {

using test::ErrorOf;
using test::kNan;
using test::MakeMap;
using test::TempDir;
using ::testing::HasSubstr;

// What the files hold, tests/cli/read_las.py reads.
TEST(LasFiles, ABadCloudIsNotWritten) {
  const TempDir dir;
  EXPECT_THAT(ErrorOf([&] { WriteLas(dir / "a.las", MapCloud{}); }), HasSubstr("no points"));
  MapCloud map = MakeMap();
  map.count.pop_back();
  EXPECT_THAT(ErrorOf([&] { WriteLas(dir / "a.las", map); }), HasSubstr("2 points but 1"));
  for (const float wrong : {kNan, 2.2e5F, -2.2e5F}) {
    map = MakeMap();
    map.points[1].z() = wrong;
    EXPECT_THAT(ErrorOf([&] { WriteLas(dir / "a.las", map); }), HasSubstr("214748")) << wrong;
  }
  EXPECT_FALSE(std::filesystem::exists(dir / "a.las"));
  WriteLas(dir / "a.las", MakeMap());
  EXPECT_EQ(ReadWholeFile(dir / "a.las").substr(0, 4), "LASF");
}

TEST(LasFiles, TheEndingDecides) {
  const std::pair<const char*, std::optional<LasKind>> names[] = {
      {"a.las", LasKind::kPlain},      {"A.LAS", LasKind::kPlain},
      {"a.laz", LasKind::kLaz},        {"d/a.b.LAZ", LasKind::kLaz},
      {"a.copc.laz", LasKind::kCopc},  {"a.Copc.LAZ", LasKind::kCopc},
      {"a.copc.las", LasKind::kPlain}, {"copc.laz", LasKind::kLaz},
      {".laz", std::nullopt},          {"a.ply", std::nullopt},
      {"a.laz/a", std::nullopt}};
  for (const auto& [name, kind] : names) EXPECT_EQ(LasKindOf(name), kind) << name;
}

TEST(LasFiles, ABadCloudIsNotCompressedEither) {
  const TempDir dir;
  MapCloud map = MakeMap();
  map.points[1].z() = kNan;
  for (const char* name : {"a.laz", "a.copc.laz"}) {
    EXPECT_THAT(ErrorOf([&] { WriteLas(dir / name, MapCloud{}); }), HasSubstr("no points"));
    EXPECT_THAT(ErrorOf([&] { WriteLas(dir / name, map); }), HasSubstr("214748"));
    EXPECT_FALSE(std::filesystem::exists(dir / name));
    WriteLas(dir / name, MakeMap());
    const std::string first = ReadWholeFile(dir / name);
    WriteLas(dir / name, MakeMap());
    EXPECT_TRUE(ReadWholeFile(dir / name) == first) << "the same cloud, other bytes";
  }
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
