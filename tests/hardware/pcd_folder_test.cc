#include "services/drivers/lidar/internal/pcd_folder.h"

#include <gmock/gmock.h>

#include <cstdlib>
#include <fstream>

#include "calib/files/points/cloud_files.h"
#include "calib/model/errors.h"
#include "tests/hardware/device_harness.h"
#include "tests/numbers.h"

namespace rgbdt {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

class PcdFolderTest : public ::testing::Test {
 protected:
  PcdFolderTest() {
    std::string name = (fs::temp_directory_path() / "rgbdt_pcds_XXXXXX").string();
    device_.folder = mkdtemp(name.data());
    device_.period_s = 0.02;
  }
  ~PcdFolderTest() override { fs::remove_all(device_.folder); }

  // Points whose x says which file they are of.
  void Write(const std::string& name, float x, Utime utime = 0) const {
    Cloud cloud;
    cloud.lines = 2;
    cloud.beams = 3;
    for (int i = 0; i < 6; ++i) cloud.points.emplace_back(x, static_cast<float>(i), 1.0F);
    if (utime != 0) {
      for (int i = 0; i < 6; ++i) cloud.utime.push_back(utime + 100 * i);
    }
    WritePcd(fs::path(device_.folder) / name, cloud);
  }

  Collected PlayAll() {
    PcdFolder folder(device_);
    Collected collected;
    DeviceThread thread([&](DeviceThread& self) { folder.Serve(self); });
    EXPECT_TRUE(Collect(&thread, &collected, [&](const Collected&) { return thread.ended(); }));
    EXPECT_EQ(folder.report().count("sweeps"),
              static_cast<std::int64_t>(collected.Count<CloudChunk>()));
    return collected;
  }

  PcdFolderDevice device_;
};

TEST_F(PcdFolderTest, InOrderWithTheirOwnTimes) {
  Write("b.pcd", 2, kJune2015 + 50'000);
  Write("a.pcd", 1, kJune2015);
  Write("c.pcd", 3, kJune2015 + 120'000);
  const auto begin = std::chrono::steady_clock::now();
  const Collected collected = PlayAll();
  EXPECT_GE(std::chrono::steady_clock::now() - begin, std::chrono::milliseconds(119));
  const auto chunks = collected.All<CloudChunk>();
  ASSERT_EQ(chunks.size(), 3u);
  EXPECT_EQ(chunks[0].cloud.sweep_utime, kJune2015);
  EXPECT_EQ(chunks[1].cloud.sweep_utime, kJune2015 + 50'000);
  EXPECT_EQ(chunks[2].cloud.sweep_utime, kJune2015 + 120'000);
  for (int i = 0; i < 3; ++i) {
    EXPECT_TRUE(chunks[static_cast<std::size_t>(i)].sweep_end);
    EXPECT_EQ(chunks[static_cast<std::size_t>(i)].sweep_lines, 2);
    EXPECT_EQ(chunks[static_cast<std::size_t>(i)].cloud.points[0].x(), static_cast<float>(i + 1));
  }
}

TEST_F(PcdFolderTest, TimesFromNamesOrApart) {
  Write("1433160000.00.pcd", 1);
  Write("scan_1433160000.05.pcd", 2);
  Write("z.pcd", 3);
  const auto chunks = PlayAll().All<CloudChunk>();
  ASSERT_EQ(chunks.size(), 3u);
  EXPECT_EQ(chunks[0].cloud.sweep_utime, kJune2015);
  EXPECT_EQ(chunks[1].cloud.sweep_utime, kJune2015 + 50'000);
  EXPECT_EQ(chunks[2].cloud.sweep_utime, kJune2015 + 70'000);
}

TEST_F(PcdFolderTest, BadOnesAreNamedAndPassedOver) {
  Write("1.pcd", 1, kJune2015);
  std::ofstream(fs::path(device_.folder) / "2.pcd") << "no cloud";
  Write("3.pcd", 3, kJune2015 - 10);
  Write("4.pcd", 4, kJune2015 + 10'000);
  std::ofstream(fs::path(device_.folder) / "readme.txt") << "not looked at";
  const Collected collected = PlayAll();
  ASSERT_EQ(collected.Count<CloudChunk>(), 2u);
  ASSERT_EQ(collected.warnings.size(), 2u);
  EXPECT_THAT(collected.warnings[0], HasSubstr("2.pcd"));
  EXPECT_THAT(collected.warnings[1], HasSubstr("3.pcd: its time"));
}

TEST_F(PcdFolderTest, WithoutFilesOrFolderSaysSo) {
  const auto why = [](const PcdFolderDevice& device) {
    try {
      PcdFolder folder(device);
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_THAT(why(device_), HasSubstr("holds no *.pcd"));
  PcdFolderDevice missing;
  missing.folder = device_.folder + "/missing";
  EXPECT_THAT(why(missing), HasSubstr("/missing: No such file"));
}

}  // namespace
}  // namespace rgbdt
