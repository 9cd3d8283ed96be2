#include "calib/files/points/cloud_files.h"

#include <gmock/gmock.h>
#include <pcl/PCLPointCloud2.h>
#include <pcl/io/pcd_io.h>

#include <cmath>
#include <cstdio>
#include <tuple>

#include "calib/files/atomic_file.h"
#include "tests/unit/files/test_data.h"

namespace rgbdt {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::NanSensitiveFloatEq;

std::string Ascii(const std::string& fields, const std::string& types, int width, int height,
                  const std::string& rows) {
  std::string sizes, counts;
  for (const char c : types) {
    if (c == ' ') continue;
    sizes += c == 'D' ? " 8" : " 4";
    counts += " 1";
  }
  std::string pcd_types = types;
  std::replace(pcd_types.begin(), pcd_types.end(), 'D', 'F');
  return "# .PCD v0.7\nVERSION 0.7\nFIELDS " + fields + "\nSIZE" + sizes + "\nTYPE " + pcd_types +
         "\nCOUNT" + counts + "\nWIDTH " + std::to_string(width) + "\nHEIGHT " +
         std::to_string(height) + "\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " +
         std::to_string(width * height) + "\nDATA ascii\n" + rows;
}

TEST(CloudFiles, PcdGivesBackEveryBit) {
  const test::TempDir dir;
  const Cloud cloud = test::MakeCloud();
  WritePcd(dir / "cloud.pcd", cloud);
  test::ExpectSame(ReadSweep(dir / "cloud.pcd", cloud.sweep_utime), cloud);
}

TEST(CloudFiles, PcdGivesBackOneOrganisedLineAndACloudWithoutOrder) {
  const test::TempDir dir;
  Cloud cloud = test::MakeCloud();
  cloud.lines = 1;
  cloud.beams = 20;
  cloud.origins.resize(1);
  WritePcd(dir / "cloud.pcd", cloud);
  test::ExpectSame(ReadSweep(dir / "cloud.pcd", cloud.sweep_utime), cloud);

  cloud.organised = false;
  cloud.first_line = 0;
  WritePcd(dir / "cloud.pcd", cloud);
  test::ExpectSame(ReadSweep(dir / "cloud.pcd", cloud.sweep_utime), cloud);

  Cloud bare;
  bare.lines = 1;
  bare.beams = 2;
  bare.organised = false;
  bare.points = {{1, 2, 3}, {4, 5, 6}};
  WritePcd(dir / "cloud.pcd", bare);
  test::ExpectSame(ReadSweep(dir / "cloud.pcd"), bare);
}

TEST(CloudFiles, PclReadsWhatIsWritten) {
  const test::TempDir dir;
  const Cloud cloud = test::MakeCloud();
  WritePcd(dir / "cloud.pcd", cloud);
  pcl::PCLPointCloud2 read;
  ASSERT_EQ(pcl::PCDReader().read((dir / "cloud.pcd").string(), read), 0);
  EXPECT_EQ(read.width, 5u);
  EXPECT_EQ(read.height, 4u);
  ASSERT_EQ(read.fields[5].name, "utime");
  double utime;
  std::memcpy(&utime, &read.data[read.fields[5].offset + 2 * read.point_step], sizeof utime);
  EXPECT_EQ(utime, static_cast<double>(cloud.utime[2]));
}

TEST(CloudFiles, ReadsEveryKindThatPclWrites) {
  const test::TempDir dir;
  const Cloud cloud = test::MakeCloud();
  WritePcd(dir / "cloud.pcd", cloud);
  pcl::PCLPointCloud2 read;
  ASSERT_EQ(pcl::PCDReader().read((dir / "cloud.pcd").string(), read), 0);
  pcl::PCDWriter writer;
  const Eigen::Vector4f origin = Eigen::Vector4f::Zero();
  const Eigen::Quaternionf none = Eigen::Quaternionf::Identity();
  writer.writeBinaryCompressed((dir / "compressed.pcd").string(), read, origin, none);
  test::ExpectSame(ReadSweep(dir / "compressed.pcd", cloud.sweep_utime), cloud);
  writer.writeBinary((dir / "binary.pcd").string(), read, origin, none);
  test::ExpectSame(ReadSweep(dir / "binary.pcd", cloud.sweep_utime), cloud);
  writer.writeASCII((dir / "ascii.pcd").string(), read, origin, none, 17);
  test::ExpectSame(ReadSweep(dir / "ascii.pcd", cloud.sweep_utime), cloud);
  // The compressed file, cut short and damaged.
  const std::string bytes = ReadWholeFile(dir / "compressed.pcd");
  const auto parse = [](const std::string& b) { ParsePcd(b, "c.pcd"); };
  test::ParseTruncations(bytes, parse);
  test::ParseDamaged(bytes, parse);
}

TEST(CloudFiles, TakesFieldsByNameAndOfAnyType) {
  const Cloud cloud = ParsePcd(
      Ascii("ring z y x intensity", "U D F I F", 2, 1, "3 0.5 -1.25 7 51\n4 1 2 3 255\n"), "a.pcd");
  ASSERT_EQ(cloud.size(), 2u);
  EXPECT_EQ(cloud.points[0], Eigen::Vector3f(7, -1.25f, 0.5f));
  EXPECT_THAT(cloud.ring, ElementsAre(3, 4));
  EXPECT_THAT(cloud.intensity, ElementsAre(0.2f, 1.f));
  EXPECT_FALSE(cloud.organised);
  EXPECT_EQ(cloud.lines, 1);
  EXPECT_EQ(cloud.beams, 2);
  EXPECT_TRUE(cloud.utime.empty());
  EXPECT_TRUE(cloud.directions.empty());
}

// Padding as it comes from a LIDAR's driver by way of PCL, some of it of no bytes.
TEST(CloudFiles, PaddingIsSkippedAlsoWhereItIsOfNoBytes) {
  const std::string head =
      "FIELDS x y z _ ring _ time _\nSIZE 4 4 4 1 2 1 4 1\nTYPE F F F U U U F U\n"
      "COUNT 1 1 1 4 1 0 1 2\nWIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA ";
  std::string points;
  const auto append = [&](const auto& value) {
    points.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  for (const float x : {1.F, 4.F}) {
    for (const float coordinate : {x, x + 1, x + 2}) append(coordinate);
    append(std::uint32_t{0xffffffff});
    append(static_cast<std::uint16_t>(x));
    append(0.1F * x);
    append(std::uint16_t{0xffff});
  }
  const Cloud binary = ParsePcd(head + "binary\n" + points, "a.pcd");
  const Cloud ascii =
      ParsePcd(head + "ascii\n1 2 3 9 9 9 9 1 0.1 9 9\n4 5 6 9 9 9 9 4 0.4 9 9\n", "a.pcd");
  for (const Cloud& cloud : {binary, ascii}) {
    ASSERT_EQ(cloud.size(), 2u);
    EXPECT_EQ(cloud.points[1], Eigen::Vector3f(4, 5, 6));
    EXPECT_THAT(cloud.ring, ElementsAre(1, 4));
    EXPECT_THAT(cloud.utime, ElementsAre(100'000, 400'000));
  }
}

TEST(CloudFiles, IntensityIsBroughtToZeroToOne) {
  const auto read = [](const std::string& values) {
    return ParsePcd(Ascii("x y z intensity", "F F F F", 2, 1, values), "a.pcd").intensity;
  };
  EXPECT_THAT(read("1 2 3 0.25\n1 2 3 1\n"), ElementsAre(0.25f, 1.f));
  EXPECT_THAT(read("1 2 3 0\n1 2 3 51\n"), ElementsAre(0.f, 0.2f));
  EXPECT_THAT(read("1 2 3 0\n1 2 3 13107\n"), ElementsAre(0.f, 0.2f));
}

TEST(CloudFiles, TimesCountFromTheSweepOrFrom1970) {
  const auto read = [](const std::string& field, const std::string& type,
                       const std::string& value) {
    return ParsePcd(Ascii("x y z " + field, "F F F " + type, 1, 1, "1 2 3 " + value + "\n"),
                    "a.pcd", 1'000'000'000)
        .utime;
  };
  EXPECT_THAT(read("utime", "D", "1700000000123457"), ElementsAre(1'700'000'000'123'457));
  EXPECT_THAT(read("time", "F", "0.25"), ElementsAre(1'000'250'000));
  EXPECT_THAT(read("t", "U", "99000000"), ElementsAre(1'000'099'000));
  EXPECT_THAT(read("timestamp", "D", "1700000000.5"), ElementsAre(1'700'000'000'500'000));
  EXPECT_THAT(test::ErrorOf([&] { read("time", "F", "nan"); }), HasSubstr("time"));
}

TEST(CloudFiles, APlyIsASweep) {
  const test::TempDir dir;
  test::WriteQuickly(dir / "s.ply",
                     "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                     "property double z\nproperty uchar intensity\nproperty ushort ring\n"
                     "end_header\n1 2 3 51 4\n0 0 0 0 0\n4 5 6 255 1\n");
  const Cloud cloud = ReadSweep(dir / "s.ply");
  ASSERT_EQ(cloud.size(), 3u);
  EXPECT_FALSE(cloud.organised);
  EXPECT_EQ(cloud.points[2], Eigen::Vector3f(4, 5, 6));
  EXPECT_FALSE(cloud.IsHit(1));
  EXPECT_THAT(cloud.ring, ElementsAre(4, 0, 1));
  EXPECT_FLOAT_EQ(cloud.intensity[0], 0.2f);
  test::WriteQuickly(dir / "huge.ply",
                     "ply\nformat ascii 1.0\nelement vertex 30000000\n"
                     "property float x\nend_header\n");
  EXPECT_THAT(test::ErrorOf([&] { ReadSweep(dir / "huge.ply"); }), HasSubstr("30000000 points"));
}

TEST(CloudFiles, FloatsWithoutAHeadAreKittisOrNuScenes) {
  const test::TempDir dir;
  const auto write = [&](const std::string& name, const std::vector<float>& numbers) {
    test::WriteQuickly(dir / name, std::string(reinterpret_cast<const char*>(numbers.data()),
                                               sizeof(float) * numbers.size()));
  };
  write("000001.bin", {1, 2, 3, 0.5F, 4, 5, 6, 1});
  const Cloud kitti = ReadSweep(dir / "000001.bin");
  ASSERT_EQ(kitti.size(), 2u);
  EXPECT_EQ(kitti.points[1], Eigen::Vector3f(4, 5, 6));
  EXPECT_THAT(kitti.intensity, ElementsAre(0.5F, 1.F));
  EXPECT_TRUE(kitti.ring.empty());
  write("a.pcd.bin", {1, 2, 3, 51, 7, 4, 5, 6, 255, 31});
  const Cloud nuscenes = ReadSweep(dir / "a.pcd.bin");
  EXPECT_THAT(nuscenes.ring, ElementsAre(7, 31));
  EXPECT_THAT(nuscenes.intensity, ElementsAre(0.2F, 1.F));
  write("b.bin", {1, 2, 3});
  EXPECT_THAT(test::ErrorOf([&] { ReadSweep(dir / "b.bin"); }), HasSubstr("points of 16"));
  write("d.bin", {1, 2, 3, 9, 0.1F, -4, 5, -6, 9, 0.2F, 1, 2, 3, 9, 0.3F, 1, 2, 3, -1, 0.4F});
  EXPECT_THAT(test::ErrorOf([&] { ReadSweep(dir / "d.bin"); }), HasSubstr("no intensities"));
  write("c.bin", {});
  EXPECT_THAT(test::ErrorOf([&] { ReadSweep(dir / "c.bin"); }), HasSubstr("0 bytes"));
}

// Of a sweep of 0.1 s, whatever the driver counts in.
TEST(CloudFiles, TheUnitOfTimesIsThatOfASweep) {
  const auto read = [](const std::string& field, const std::string& type, double unit, double from,
                       double seconds = 0.1) {
    std::string points;
    for (int i = 0; i < 400; ++i) {
      char text[100];
      const double time = (from + seconds * i / 400) / unit;
      std::snprintf(text, sizeof text, type == "F" || type == "D" ? "1 2 3 %.9f\n" : "1 2 3 %.0f\n",
                    time);
      points += text;
    }
    return ParsePcd(Ascii("x y z " + field, "F F F " + type, 400, 1, points), "a.pcd",
                    1'700'000'000'000'000)
        .utime;
  };
  for (const auto& [field, type, unit] :
       std::vector<std::tuple<std::string, std::string, double>>{{"t", "U", 1e-9},
                                                                 {"t", "U", 1e-6},
                                                                 {"time", "F", 1},
                                                                 {"time", "F", 1e-6},
                                                                 {"time", "F", 1e-3},
                                                                 {"time_stamp", "U", 1e-9},
                                                                 {"offset_time", "U", 1e-6}}) {
    const std::vector<Utime> utime = read(field, type, unit, 0);
    ASSERT_EQ(utime.size(), 400u) << field << type << unit;
    EXPECT_NEAR(static_cast<double>(utime[200] - 1'700'000'000'000'000), 50'000, 2)
        << field << unit;
  }
  for (const double unit : {1.0, 1e-3, 1e-6, 1e-9}) {
    const std::vector<Utime> utime = read("timestamp", "D", unit, 1'699'999'999);
    ASSERT_EQ(utime.size(), 400u) << unit;
    EXPECT_NEAR(static_cast<double>(utime[200] - 1'699'999'999'050'000), 0, 2) << unit;
  }
  // A turned scanner's, and a packet's of a millisecond.
  EXPECT_EQ(read("time", "F", 1, 0, 8)[200], 1'700'000'004'000'000);
  EXPECT_NEAR(static_cast<double>(read("t", "U", 1e-9, 0, 1.3e-3)[200]), 1'700'000'000'000'650, 2);
  EXPECT_EQ(read("timestamp", "D", 1, 1'699'999'000, 50)[200], 1'699'999'025'000'000);
  EXPECT_NEAR(static_cast<double>(read("t", "U", 1e-6, 0, 0.5)[200]), 1'700'000'000'250'000, 2);
  EXPECT_NEAR(static_cast<double>(read("timestamp", "U", 1e-6, 1'699'999'000, 8)[200]),
              1'699'999'004'000'000, 2);
  EXPECT_EQ(read("timestamp", "D", 1, 1'699'999'000, 0)[200], 1'699'999'000'000'000)
      << "of one moment";
  // Of a Livox that has been on for 1000 s and for a minute.
  for (const double from : {1000.0, 60.0}) {
    EXPECT_NEAR(static_cast<double>(read("timestamp", "D", 1e-9, from)[200]),
                1'700'000'000'050'000 + 1e6 * from, 2);
  }
  // Nobody's.
  EXPECT_THAT(read("time", "F", 1, 5, 0), IsEmpty());
  EXPECT_THAT(read("time", "F", 1, 0, 3e13), IsEmpty());
}

TEST(CloudFiles, AMissNeedsNeitherRingNorTime) {
  const Cloud cloud =
      ParsePcd(Ascii("x y z ring time", "F F F F F", 2, 1, "nan nan nan nan nan\n1 2 3 5 0.5\n"),
               "a.pcd", 1'000'000);
  EXPECT_THAT(cloud.ring, ElementsAre(0, 5));
  EXPECT_THAT(cloud.utime, ElementsAre(1'000'000, 1'500'000));
  const auto bad = [] {
    ParsePcd(Ascii("x y z ring", "F F F F", 2, 1, "1 1 1 nan\n1 2 3 5\n"), "a.pcd");
  };
  EXPECT_THAT(test::ErrorOf(bad), HasSubstr("ring"));
}

TEST(CloudFiles, AFileOfManyLinesIsOrganised) {
  const Cloud cloud = ParsePcd(
      Ascii("x y z", "F F F", 3, 2, "1 0 0\nnan nan nan\n3 0 0\n4 0 0\n0 0 0\n6 0 0\n"), "a.pcd");
  EXPECT_TRUE(cloud.organised);
  EXPECT_EQ(cloud.lines, 2);
  EXPECT_EQ(cloud.beams, 3);
  EXPECT_FALSE(cloud.IsHit(1));
  EXPECT_FALSE(cloud.IsHit(4)) << "(0, 0, 0) is a beam that returned nothing";
  EXPECT_TRUE(cloud.IsHit(5));
}

// Columns of three rings, although the header speaks of rows of six.
TEST(CloudFiles, RingsThatComeInTurnAreTheBeamsOfALine) {
  const auto read = [](const std::string& rows) {
    return ParsePcd(Ascii("x y z ring", "F F F U", 6, 2, rows), "a.pcd");
  };
  std::string in_turn, in_rows, some_missing;
  for (int i = 0; i < 12; ++i) {
    in_turn += "1 1 1 " + std::to_string(i % 3) + "\n";
    in_rows += "1 1 1 " + std::to_string(i / 6) + "\n";
    some_missing += "1 1 1 " + std::to_string(i == 7 ? 2 : i % 3) + "\n";
  }
  const Cloud columns = read(in_turn);
  EXPECT_TRUE(columns.organised);
  EXPECT_EQ(columns.lines, 4);
  EXPECT_EQ(columns.beams, 3);
  for (const std::string& rows : {in_rows, some_missing}) {
    const Cloud as_it_says = read(rows);
    EXPECT_EQ(as_it_says.lines, 2);
    EXPECT_EQ(as_it_says.beams, 6);
  }
}

TEST(CloudFiles, LineAndBeamThatDoNotFitAreNoOrder) {
  const auto organised = [](const std::string& rows) {
    return ParsePcd(Ascii("x y z line beam", "F F F I I", 4, 1, rows), "a.pcd").organised;
  };
  EXPECT_TRUE(organised("1 1 1 7 0\n1 1 1 7 1\n1 1 1 8 0\n1 1 1 8 1\n"));
  EXPECT_FALSE(organised("1 1 1 7 0\n1 1 1 8 1\n1 1 1 7 1\n1 1 1 8 1\n"));
  EXPECT_FALSE(organised("1 1 1 7 0\n1 1 1 7 1\n1 1 1 7 2\n1 1 1 8 0\n"));
  EXPECT_FALSE(organised("1 1 1 -7 0\n1 1 1 nan 1\n1 1 1 1e300 2\n1 1 1 8 1e300\n"));
}

TEST(CloudFiles, BadFilesGiveOneClearLine) {
  const auto error = [](const std::string& bytes) {
    return test::ErrorOf([&] { ParsePcd(bytes, "bad.pcd"); });
  };
  EXPECT_THAT(error(Ascii("x y intensity", "F F F", 1, 1, "1 2 3\n")), HasSubstr("no field z"));
  EXPECT_THAT(error(Ascii("x y z", "F F F", 0, 1, "")), HasSubstr("bad.pcd: holds no points"));
  EXPECT_THAT(error(Ascii("x y z", "F F F", 2, 1, "nan nan nan\n0 0 0\n")), HasSubstr("finite"));
  EXPECT_THAT(error(Ascii("x y z", "F F F", 3, 1, "1 2 3\n4 5 6\n")),
              HasSubstr("promises 3 points, 2 are there"));
  EXPECT_THAT(error(Ascii("x y z", "F F F", 2, 1, "1 2 3\n1 2 abc\n")),
              HasSubstr("bad.pcd: line 13: z is \"abc\"; expected a number"));
  EXPECT_THAT(error("FIELDS x y z\nSIZE 4 4 nine\n"), HasSubstr("line 2: SIZE is \"nine\""));
  EXPECT_THAT(error(""), HasSubstr("not a PCD file"));
  EXPECT_THAT(error("ply\nformat ascii 1.0\n"), HasSubstr("not a PCD file"));
  EXPECT_THAT(error(Ascii("x y z", "F F Q", 1, 1, "1 2 3\n")), HasSubstr("field z has TYPE Q"));
  std::string none = Ascii("x y z", "F F F", 1, 1, "1 2\n");
  none.replace(none.find("COUNT 1 1 1"), 11, "COUNT 1 1 0");
  EXPECT_THAT(error(none), HasSubstr("no field z"));
  none.replace(none.find("COUNT 1 1 0"), 11, "COUNT 0 0 0");
  EXPECT_THAT(error(none), HasSubstr("no FIELDS"));
  EXPECT_THAT(error(Ascii("x y z ring", "F F F F", 1, 1, "1 2 3 -1\n")), HasSubstr("ring"));
  std::string mismatch = Ascii("x y z", "F F F", 1, 1, "1 2 3\n");
  mismatch.replace(mismatch.find("POINTS 1"), 8, "POINTS 2");
  EXPECT_THAT(error(mismatch), HasSubstr("is not POINTS 2"));
}

TEST(CloudFiles, AForgedSizeAllocatesNothing) {
  for (const char* kind : {"ascii", "binary", "binary_compressed"}) {
    const std::string bytes =
        "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 100000\nWIDTH 199999999\nHEIGHT 1\n"
        "POINTS 199999999\nDATA " +
        std::string(kind) + "\n" + std::string(100, '\x7f');
    test::ErrorOf([&] { ParsePcd(bytes, "forged.pcd"); });
  }
}

// So many fields that the bytes of a point times the points overflow.
TEST(CloudFiles, AForgedProductOfSizesAllocatesNothing) {
  std::string fields = "FIELDS x y z", sizes = "SIZE 8 8 8", types = "TYPE F F F",
              counts = "COUNT 65536 65536 65536";
  for (int i = 3; i < 1 << 18; ++i) {
    fields += " a", sizes += " 8", types += " F", counts += " 65536";
  }
  // 2^18 fields of 2^19 bytes each, 2^27 points: 2^64 bytes.
  const std::string bytes = fields + "\n" + sizes + "\n" + types + "\n" + counts +
                            "\nWIDTH 134217728\nHEIGHT 1\nDATA binary\n" + std::string(100, 'x');
  EXPECT_THAT(test::ErrorOf([&] { ParsePcd(bytes, "forged.pcd"); }), HasSubstr("is cut short"));
}

TEST(CloudFiles, DamagedFilesNeverCrash) {
  const test::TempDir dir;
  WritePcd(dir / "cloud.pcd", test::MakeCloud());
  const auto parse = [](const std::string& bytes) { ParsePcd(bytes, "c.pcd"); };
  const std::string bytes = ReadWholeFile(dir / "cloud.pcd");
  test::ParseTruncations(bytes, parse, 2000);
  test::ParseDamaged(bytes, parse, 2000);
}

TEST(CloudFiles, RefusesToWriteWhatCannotBeRead) {
  const test::TempDir dir;
  Cloud cloud = test::MakeCloud();
  cloud.utime.pop_back();
  EXPECT_THAT(test::ErrorOf([&] { WritePcd(dir / "c.pcd", cloud); }),
              HasSubstr("19 values of utime"));
  EXPECT_THAT(test::ErrorOf([&] { WritePcd(dir / "c.pcd", Cloud{}); }), HasSubstr("no points"));
  cloud = test::MakeCloud();
  cloud.lines = 5;
  test::ErrorOf([&] { WritePcd(dir / "c.pcd", cloud); });
  EXPECT_FALSE(std::filesystem::exists(dir / "c.pcd"));
}

TEST(CloudFiles, FusedPcdHoldsEveryField) {
  const test::TempDir dir;
  const RgbdtCloud cloud = test::MakeRgbdtCloud(6, 5);
  WritePcd(dir / "fused.pcd", cloud);
  pcl::PCLPointCloud2 read;
  ASSERT_EQ(pcl::PCDReader().read((dir / "fused.pcd").string(), read), 0);
  ASSERT_EQ(read.width, 30u);
  const auto field = [&](const std::string& name, auto value, std::size_t i) {
    for (const pcl::PCLPointField& f : read.fields) {
      if (f.name == name)
        std::memcpy(&value, &read.data[i * read.point_step + f.offset], sizeof value);
    }
    return value;
  };
  for (std::size_t i = 0; i < 30; ++i) {
    EXPECT_EQ(field("x", 0.f, i), cloud.points[i].x());
    const std::uint32_t rgb = field("rgb", std::uint32_t{1}, i);
    EXPECT_EQ(rgb >> 16 & 255, cloud.rgb[i][0]);
    EXPECT_EQ(rgb & 255, cloud.rgb[i][2]);
    EXPECT_EQ(static_cast<Utime>(field("utime", 0.0, i)), cloud.utime[i]);
    EXPECT_EQ(field("valid", std::uint32_t{99}, i), cloud.valid[i]);
    EXPECT_THAT(field("temperature", 0.f, i), NanSensitiveFloatEq(cloud.temperature_k[i]));
    EXPECT_THAT(field("temperature_sigma", 0.f, i),
                NanSensitiveFloatEq(cloud.temperature_sigma_k[i]));
    EXPECT_THAT(field("thermal_counts", 0.f, i), NanSensitiveFloatEq(cloud.thermal_counts[i]));
  }
}

TEST(CloudFiles, PlyHasItsHeaderAndAllItsBytes) {
  const test::TempDir dir;
  const RgbdtCloud cloud = test::MakeRgbdtCloud(6, 5);
  WritePly(dir / "fused.ply", cloud);
  const std::string bytes = ReadWholeFile(dir / "fused.ply");
  const std::string end = "end_header\n";
  const std::size_t at = bytes.find(end) + end.size();
  const std::string header = bytes.substr(0, at);
  EXPECT_THAT(header, ::testing::StartsWith("ply\nformat binary_little_endian 1.0\n"));
  EXPECT_THAT(header, HasSubstr("\ncomment LIDAR frame: x forward, y left, z up [m]"));
  EXPECT_THAT(header, HasSubstr("\ncomment rgbdt valid_bit 1 camera thermal calibration_utime "));
  EXPECT_THAT(header, HasSubstr("\ncomment rgbdt map_from_lidar quaternion_wxyz "));
  EXPECT_THAT(header, HasSubstr("element vertex 30\nproperty float x\nproperty float y\n"
                                "property float z\nproperty uchar red\nproperty uchar green\n"
                                "property uchar blue\nproperty float intensity\n"
                                "property double utime\nproperty float temperature\n"
                                "property float temperature_sigma\nproperty float thermal_counts\n"
                                "property uint valid\nend_header\n"));
  const std::size_t stride = 12 + 3 + 4 + 8 + 12 + 4;
  ASSERT_EQ(bytes.size() - at, 30 * stride);
  float x;
  std::memcpy(&x, &bytes[at + 29 * stride], sizeof x);
  EXPECT_EQ(x, cloud.points[29].x());
  EXPECT_EQ(static_cast<std::uint8_t>(bytes[at + 15 * stride + 12]), cloud.rgb[15][0]);
}

TEST(CloudFiles, RealClouds) {
  const char* data = std::getenv("RGBDT_REAL_DATA");
  if (data == nullptr) GTEST_SKIP() << "RGBDT_REAL_DATA is not set: real clouds not read";
  const Cloud cloud = ReadSweep(std::filesystem::path(data) / "acfr_vlp16/clouds/pose3.pcd");
  EXPECT_EQ(cloud.size(), 24262u);
  EXPECT_FLOAT_EQ(cloud.points[0].x(), 0.38285658f);
  EXPECT_EQ(*std::max_element(cloud.ring.begin(), cloud.ring.end()), 15);
  EXPECT_LE(*std::max_element(cloud.intensity.begin(), cloud.intensity.end()), 1.f);
  EXPECT_FALSE(cloud.organised);
}

TEST(CloudFiles, ASweepThatCannotBeOneIsRefusedByItsHeader) {
  const test::TempDir dir;
  std::string pcd = Ascii("x y z", "F F F", 100'000, 2'000, "");
  pcd.replace(pcd.find("ascii"), 5, "binary");
  WriteFileAtomically(dir / "forged.pcd", pcd);
  std::filesystem::resize_file(dir / "forged.pcd", pcd.size() + std::size_t{12} * 200'000'000);
  EXPECT_THAT(test::ErrorOf([&] { ReadSweep(dir / "forged.pcd", 0); }),
              AllOf(HasSubstr("forged.pcd"), HasSubstr("200000000 points; expected at most")));
}

}  // namespace
}  // namespace rgbdt
