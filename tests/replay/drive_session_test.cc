#include "services/replay/drive_session.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "calib/files/schema/rig_file.h"
#include "calib/files/session/session_dir.h"
#include "calib/scan_assembly/sweep_chunks.h"
#include "calib/simulate/driving.h"
#include "services/import/timed_log.h"
#include "tests/simulated_variants.h"
#include "tests/unit/files/test_data.h"

namespace rgbdt {
namespace {

using simulate::Driving;

constexpr Utime kSweep = 100'000;
constexpr int kSweeps = 16;

// 3 m/s along a street, an image in every fifth sweep.
std::filesystem::path LogOf(const std::filesystem::path& path, Driving* driving,
                            Utime every = kSweep) {
  const Rig rig = ParseRig(PrintRig(driving->rig()), "rig");
  TimedLog log(path.string());
  for (int i = 0; i < kSweeps; ++i) {
    const Utime begin = Driving::kStart + i * every;
    if (i % 10 == 0) log.AddRig(rig, std::nullopt, begin);
    for (CloudChunk& chunk : SplitSweep(driving->Sweep(begin))) {
      log.Add(std::move(chunk), begin + kSweep);
    }
    if (i % 5 == 2) log.Add(driving->TakeImage("rgb", begin + 40'000), begin + 50'000);
  }
  log.Close();
  return path;
}

TEST(DriveSession, WithoutPosesTheSweepsTellTheMotion) {
  const test::TempDir dir;
  Driving driving(simulate::OneCamera(4, 16, 160), 3);
  const std::filesystem::path log = LogOf(dir / "drive.lcmlog", &driving);
  CutOptions options;
  options.every = 3 * kSweep;
  const CutDrive cut = CutIntoSession(log, dir / "session", options);
  EXPECT_TRUE(cut.by_odometry);
  EXPECT_FALSE(cut.motion_unknown);
  ASSERT_GE(cut.views, 2U);
  const Session session = OpenSession(dir / "session");
  const View first = ReadView(session, session.views.at(0));
  for (const std::string& name : session.views) {
    const View view = ReadView(session, name);
    const Utime taken = view.images.at(0).utime;
    const Utime begin = view.cloud.sweep_utime;
    EXPECT_GE(taken, begin) << "of the sweep's own time";
    EXPECT_LT(taken, begin + kSweep);
    ASSERT_TRUE(view.map_from_lidar);
    const Rigid3 since = first.map_from_lidar->Inverse() * *view.map_from_lidar;
    const Rigid3 truth =
        driving.WorldFromLidar(first.images.at(0).utime).Inverse() * driving.WorldFromLidar(taken);
    EXPECT_LT((since.translation - truth.translation).norm(), 0.05) << name;
    const Cloud swept = driving.Sweep(begin);
    ASSERT_EQ(view.cloud.size(), swept.size());
    std::vector<double> off, off_standing;
    for (std::size_t i = 0; i < swept.size(); ++i) {
      if (!swept.IsHit(i) || !view.cloud.IsHit(i)) continue;
      const Rigid3 there =
          driving.WorldFromLidar(taken).Inverse() * driving.WorldFromLidar(swept.utime[i]);
      const Eigen::Vector3d point = swept.points[i].cast<double>();
      off.push_back((view.cloud.points[i].cast<double>() - there * point).norm());
      off_standing.push_back((point - there * point).norm());
    }
    const auto most_of = [](std::vector<double>* values) {
      const auto at = values->begin() + static_cast<std::ptrdiff_t>(0.9 * values->size());
      std::nth_element(values->begin(), at, values->end());
      return *at;
    };
    ASSERT_GT(off.size(), 5000U);
    EXPECT_LT(most_of(&off), 0.03) << name;
    EXPECT_GT(most_of(&off_standing), 0.1) << name;
  }
}

TEST(DriveSession, SweepsFarApartTellNoMotionAndThatIsSaid) {
  const test::TempDir dir;
  Driving driving(simulate::OneCamera(4, 16, 160), 3);
  const std::filesystem::path log = LogOf(dir / "drive.lcmlog", &driving, 8 * kSweep);
  const CutDrive cut = CutIntoSession(log, dir / "session");
  EXPECT_FALSE(cut.by_odometry);
  EXPECT_TRUE(cut.motion_unknown);
  ASSERT_FALSE(cut.problems.empty());
  EXPECT_NE(cut.problems[0].find("neither POSE nor the sweeps"), std::string::npos);
}

}  // namespace
}  // namespace rgbdt
