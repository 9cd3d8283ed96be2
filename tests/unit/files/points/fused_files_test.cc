#include <gmock/gmock.h>

#include <cmath>
#include <functional>

#include "calib/files/atomic_file.h"
#include "calib/files/points/cloud_files.h"
#include "tests/unit/files/test_data.h"

namespace rgbdt {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsNan;
using Rgb = std::array<std::uint8_t, 3>;

void ExpectSame(const std::vector<float>& a, const std::vector<float>& b) {
  EXPECT_THAT(a, ::testing::Pointwise(::testing::NanSensitiveFloatEq(), b));
}

void ExpectSame(const RgbdtCloud& a, const RgbdtCloud& b) {
  EXPECT_EQ(a.sweep_utime, b.sweep_utime);
  EXPECT_EQ(a.sweep_end, b.sweep_end);
  EXPECT_EQ(a.whole_sweep, b.whole_sweep);
  EXPECT_EQ(a.cameras, b.cameras);
  EXPECT_EQ(a.calibration_utime, b.calibration_utime);
  ASSERT_EQ(a.map_from_lidar.has_value(), b.map_from_lidar.has_value());
  if (a.map_from_lidar) test::ExpectSame(*a.map_from_lidar, *b.map_from_lidar);
  EXPECT_EQ(a.frame_utime, b.frame_utime);
  EXPECT_EQ(a.points, b.points);
  EXPECT_EQ(a.intensity, b.intensity);
  EXPECT_EQ(a.utime, b.utime);
  EXPECT_EQ(a.rgb, b.rgb);
  ExpectSame(a.temperature_k, b.temperature_k);
  ExpectSame(a.temperature_sigma_k, b.temperature_sigma_k);
  ExpectSame(a.thermal_counts, b.thermal_counts);
  EXPECT_EQ(a.valid, b.valid);
}

std::string Written(const RgbdtCloud& cloud, const std::string& name) {
  const test::TempDir dir;
  if (name == "c.ply") WritePly(dir / name, cloud);
  if (name == "c.pcd") WritePcd(dir / name, cloud);
  return ReadWholeFile(dir / name);
}

std::string Ply(const std::string& properties, const std::string& data, int count = 1,
                const std::string& format = "ascii") {
  return "ply\nformat " + format + " 1.0\nelement vertex " + std::to_string(count) + "\n" +
         properties + "end_header\n" + data;
}

constexpr char kXyz[] = "property float x\nproperty float y\nproperty float z\n";

std::string ErrorOf(const std::string& bytes) {
  return test::ErrorOf([&] { ParseFused(bytes, "bad"); });
}

class FusedFiles : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Kinds, FusedFiles, ::testing::Values("c.ply", "c.pcd"));

TEST_P(FusedFiles, GiveBackEveryBit) {
  const test::TempDir dir;
  RgbdtCloud cloud = test::MakeRgbdtCloud(6, 5);
  test::WriteQuickly(dir / "fused", Written(cloud, GetParam()));
  ExpectSame(ReadFused(dir / "fused"), cloud);
  cloud.map_from_lidar.reset();
  cloud.frame_utime = 0;
  cloud.sweep_end = cloud.whole_sweep = false;
  cloud.cameras.clear();
  cloud.calibration_utime.clear();
  cloud.valid.assign(cloud.size(), 0);
  ExpectSame(ParseFused(Written(cloud, GetParam()), "c"), cloud);
}

TEST_P(FusedFiles, EveryTruncationIsRefused) {
  const std::string bytes = Written(test::MakeRgbdtCloud(3, 2), GetParam());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_THAT(ErrorOf(bytes.substr(0, size)), HasSubstr("bad: "));
  }
}

TEST_P(FusedFiles, DamageNeverCrashes) {
  const std::string bytes = Written(test::MakeRgbdtCloud(3, 2), GetParam());
  test::ParseDamaged(
      bytes, [](const std::string& b) { ParseFused(b, "c"); }, bytes.size());
}

TEST_P(FusedFiles, ForgedCommentsAreRefused) {
  const std::string good = Written(test::MakeRgbdtCloud(3, 2), GetParam());
  const auto error = [&](const std::string& from, const std::string& to) {
    std::string bytes = good;
    bytes.replace(bytes.find(from), from.size(), to);
    return ErrorOf(bytes);
  };
  EXPECT_THAT(error("sweep_utime 1", "sweep_utime x"), HasSubstr("comment \""));
  EXPECT_THAT(error("sweep_utime 1", "sweep_utime 5000"), HasSubstr("from 0 to 4000000000000"));
  EXPECT_THAT(error("valid_bit 1", "valid_bit 3"), HasSubstr("expected bit 1"));
  EXPECT_THAT(error("camera thermal", "camera"), HasSubstr("expected"));
  EXPECT_THAT(error("quaternion_wxyz ", "quaternion_wxyz 7"), HasSubstr("a unit quaternion"));
  EXPECT_THAT(error("translation_m ", "translation_m nan "), HasSubstr("expected"));
  EXPECT_THAT(error("rgbdt valid_bit 1", "of no use   1"), HasSubstr("valid is"));
}

TEST_P(FusedFiles, ACameraOfAnyNameIsOneWordInOneLine) {
  RgbdtCloud cloud = test::MakeRgbdtCloud(3, 2);
  cloud.cameras = {"a b\nend_header", ""};
  EXPECT_THAT(ParseFused(Written(cloud, GetParam()), "c").cameras,
              ElementsAre("a?b?end_header", "?"));
}

TEST(FusedReader, TakesAnybodysPly) {
  const RgbdtCloud cloud = ParseFused(
      "ply\r\nformat ascii 1.0\r\ncomment made by hand\r\nobj_info one\r\nelement vertex 3\r\n"
      "property uchar red\r\nproperty uchar green\r\nproperty uchar blue\r\n"
      "property double x\r\nproperty float32 y\r\nproperty int z\r\nproperty float quality\r\n"
      "element face 1\r\nproperty list uchar int vertex_indices\r\nend_header\r\n"
      "1 2 3 4.5 5 6 0.1\r\n10 20 255 -4.5 5 6 0.2\r\n0 0 0 nan 5 6 0.3\r\n3 0 1 2\r\n",
      "mesh.ply");
  EXPECT_THAT(cloud.points, ElementsAre(Eigen::Vector3f(4.5f, 5, 6), Eigen::Vector3f(-4.5f, 5, 6)));
  EXPECT_THAT(cloud.rgb, ElementsAre(Rgb{1, 2, 3}, Rgb{10, 20, 255}));
  EXPECT_THAT(cloud.intensity, ElementsAre(IsNan(), IsNan()));
  EXPECT_THAT(cloud.temperature_k, ElementsAre(IsNan(), IsNan()));
  EXPECT_THAT(cloud.temperature_sigma_k, ElementsAre(IsNan(), IsNan()));
  EXPECT_THAT(cloud.valid, ElementsAre(0u, 0u));
  EXPECT_THAT(cloud.utime, ElementsAre(0, 0));
  EXPECT_TRUE(cloud.cameras.empty());
}

TEST(FusedReader, TakesColoursInTheirUsualSpellings) {
  const auto rgb = [](const std::string& properties, const std::string& row) {
    return ParseFused(Ply(kXyz + properties, "1 2 3 " + row + "\n"), "c.ply").rgb.at(0);
  };
  EXPECT_EQ(rgb("property int r\nproperty int g\nproperty int b\n", "7 300 -9"), (Rgb{7, 255, 0}));
  EXPECT_EQ(rgb("property float red\nproperty float green\nproperty float blue\n", "1 0.2 nan"),
            (Rgb{255, 51, 0}));
  EXPECT_EQ(rgb("property uint rgb\n", "66051"), (Rgb{1, 2, 3}));
  EXPECT_EQ(rgb("property float rgb\n", "66051"), (Rgb{1, 2, 3}));
  EXPECT_EQ(rgb("property float rgb\n", "9.2557e-41"), (Rgb{1, 2, 3})) << "the bits of a float";
  EXPECT_EQ(rgb("property uint red\n", "3"), (Rgb{0, 0, 0})) << "one of three is no colour";
}

// PCL sets the fourth byte, which makes a bright red a NaN: its bits must come through.
TEST(FusedReader, APackedColourThatIsANanAsAFloat) {
  for (const char* kind : {"float", "uint", "int"}) {
    const std::string bytes = Ply(std::string(kXyz) + "property " + kind + " rgba\n",
                                  std::string("\0\0\x80\x3f\0\0\x80\x3f\0\0\x80\x3f", 12) +
                                      std::string("\x03\x02\x81\xff", 4),
                                  1, "binary_little_endian");
    EXPECT_THAT(ParseFused(bytes, "c.ply").rgb, ElementsAre(Rgb{0x81, 2, 3}));
  }
}

TEST(FusedReader, TakesThePlainPcd) {
  const test::TempDir dir;
  const Cloud cloud = test::MakeCloud();
  WritePcd(dir / "cloud.pcd", cloud);
  const RgbdtCloud read = ReadFused(dir / "cloud.pcd");
  std::size_t hits = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!cloud.IsHit(i)) continue;
    ASSERT_LT(hits, read.size());
    EXPECT_EQ(read.points[hits], cloud.points[i]);
    EXPECT_EQ(read.utime[hits], cloud.utime[i]);
    EXPECT_EQ(read.intensity[hits], cloud.intensity[i]);
    ++hits;
  }
  EXPECT_EQ(read.size(), hits);
  EXPECT_LT(hits, cloud.size()) << "there were misses to leave out";
}

TEST(FusedReader, BadPlyFilesGiveOneClearLine) {
  EXPECT_THAT(ErrorOf("plywood\n"), HasSubstr("its first line is not \"ply\""));
  EXPECT_THAT(
      ErrorOf("ply\nformat binary_big_endian 1.0\n"),
      AllOf(HasSubstr("bad: PLY header, line 2"), HasSubstr("expected ascii or binary_li")));
  EXPECT_THAT(ErrorOf("ply\nelement vertex 1\nend_header\n"), HasSubstr("no format"));
  EXPECT_THAT(ErrorOf("ply\nformat ascii 1.0\nend_header\n"), HasSubstr("no element vertex"));
  EXPECT_THAT(ErrorOf("ply\nformat ascii 1.0\nproperty float x\n"),
              HasSubstr("line 3: a property"));
  EXPECT_THAT(ErrorOf("ply\nformat ascii 1.0\nelement face 3\n"),
              HasSubstr("line 3: expected element vertex"));
  EXPECT_THAT(ErrorOf(Ply("", "")), HasSubstr("no properties"));
  EXPECT_THAT(ErrorOf(Ply(kXyz, "", 0)), HasSubstr("holds no points"));
  EXPECT_THAT(ErrorOf(Ply("property float x\nproperty float y\n", "1 2\n")),
              HasSubstr("no field z"));
  EXPECT_THAT(ErrorOf(Ply("property quad x\n", "1\n")),
              HasSubstr("line 4: property x is of type \"quad\""));
  EXPECT_THAT(ErrorOf(Ply("property list uchar int x\n", "1\n")), HasSubstr("no lists"));
  EXPECT_THAT(ErrorOf(Ply(kXyz, "1 2 3\n1 two 3\n", 2)),
              HasSubstr("bad: line 9: y is \"two\"; expected a number"));
  EXPECT_THAT(ErrorOf(Ply(kXyz, "1 2 3\n4 5\n", 2)), HasSubstr("promises 2 points, 1 are there"));
  EXPECT_THAT(ErrorOf(Ply(kXyz, "0 0 0\nnan 1 2\n", 2)), HasSubstr("finite coordinates"));
}

TEST(FusedReader, AForgedCountAllocatesNothing) {
  for (const char* format : {"ascii", "binary_little_endian"}) {
    EXPECT_THAT(ErrorOf(Ply(kXyz, std::string(100, '1'), 199'999'999, format)),
                HasSubstr("is cut short"));
    EXPECT_THAT(ErrorOf(Ply(kXyz, "1 2 3\n", 2'000'000'000, format)),
                HasSubstr("number of vertices is \"2000000000\""));
    EXPECT_THAT(ErrorOf(Ply(kXyz, "1 2 3\n", -1, format)), HasSubstr("vertices is \"-1\""));
  }
}

TEST(FusedWriters, RefuseWhatCannotBeRead) {
  const test::TempDir dir;
  const auto error = [&](const std::function<void(RgbdtCloud*)>& change) {
    RgbdtCloud cloud = test::MakeRgbdtCloud(3, 2);
    change(&cloud);
    return test::ErrorOf([&] { WritePly(dir / "c.ply", cloud); });
  };
  EXPECT_THAT(error([](RgbdtCloud* c) { c->temperature_sigma_k.pop_back(); }),
              HasSubstr("5 values of temperature's sigma"));
  EXPECT_THAT(error([](RgbdtCloud* c) { c->calibration_utime.pop_back(); }),
              HasSubstr("2 cameras but 1 times"));
  EXPECT_FALSE(std::filesystem::exists(dir / "c.ply"));
}

}  // namespace
}  // namespace rgbdt
