#include "calib/simulate/internal/livox.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "calib/simulate/internal/cloud_world.h"

namespace rgbdt::simulate {
namespace {

constexpr Utime kUtime = 1'000'000'000;

// By the data sheets: 70.4 by 77.2 degrees; all the way round, -7 to 52 degrees.
TEST(LivoxPattern, FillsTheFieldOfTheDataSheets) {
  double across = 0, up = 0, low = 90, high = -90;
  for (int i = 0; i < 400'000; ++i) {
    const double time_s = i * 1e-5;
    const Eigen::Vector3d a = LivoxDirection(LivoxModel::kAvia, time_s, i % 6);
    EXPECT_NEAR(a.norm(), 1, 1e-12);
    const double off = std::acos(std::min(1.0, a.x())), flat = std::hypot(a.y(), a.z());
    if (flat > 0) across = std::max(across, off * std::abs(a.y()) / flat / kDegree);
    if (flat > 0) up = std::max(up, off * std::abs(a.z()) / flat / kDegree);
    const Eigen::Vector3d m = LivoxDirection(LivoxModel::kMid360, time_s, i % 4);
    low = std::min(low, std::asin(m.z()) / kDegree);
    high = std::max(high, std::asin(m.z()) / kDegree);
  }
  EXPECT_NEAR(2 * across, 70.4, 0.2);
  EXPECT_NEAR(2 * up, 77.2, 0.3);
  EXPECT_NEAR(low, -7, 0.1);
  EXPECT_NEAR(high, 52, 0.1);
}

// Of cells of half a degree in front of the sensor a second sees more than a tenth of it.
TEST(LivoxPattern, DoesNotRepeat) {
  for (const LivoxModel model : {LivoxModel::kMid360, LivoxModel::kAvia}) {
    const LivoxOptions options = LivoxLidar(model);
    const int lasers = LivoxLasers(model);
    const auto seen = [&](double seconds) {
      std::vector<bool> cells(40 * 40);
      for (int i = 0; i < seconds * options.points_per_s; ++i) {
        const double time_s = i / lasers * lasers / options.points_per_s;
        const Eigen::Vector3d d = LivoxDirection(model, time_s, i % lasers);
        const double y = std::atan2(d.y(), d.x()) / kDegree, z = std::asin(d.z()) / kDegree;
        if (std::abs(y) >= 10 || z < 0 || z >= 20) continue;
        cells[static_cast<std::size_t>((y + 10) * 2) * 40 + static_cast<std::size_t>(z * 2)] = true;
      }
      return static_cast<double>(std::count(cells.begin(), cells.end(), true)) / 1600;
    };
    EXPECT_GT(seen(1), 1.2 * seen(0.1));
  }
}

TEST(LivoxCloud, HoldsHitsInTheirOrder) {
  for (const int lidar : {kMid360, kAvia}) {
    Options options;
    UseLidar(lidar, &options);
    options.livox->seconds = 0.1;
    const CloudWorld world(options, 0);
    const Cloud cloud = world.Sweep(kUtime);
    EXPECT_FALSE(cloud.organised);
    EXPECT_TRUE(cloud.ring.empty());
    EXPECT_GT(cloud.size(), 1000U);
    EXPECT_EQ(cloud.beams, static_cast<int>(cloud.size()));
    EXPECT_TRUE(std::is_sorted(cloud.utime.begin(), cloud.utime.end()));
    EXPECT_LT(cloud.utime.back(), kUtime + 100'000);
    const Cloud again = world.Sweep(kUtime), later = world.Sweep(kUtime + 100'000);
    ASSERT_EQ(again.size(), cloud.size());
    EXPECT_EQ(again.points.back(), cloud.points.back());
    EXPECT_NE(later.points.front(), cloud.points.front());
    // On the board's front, within 5 sigma.
    const Rigid3 target_from_lidar = world.lidar_from_target().Inverse();
    int on = 0;
    double mean = 0;
    for (const Eigen::Vector3f& point : cloud.points) {
      const Eigen::Vector3d p = target_from_lidar * point.cast<double>();
      if (std::abs(p.x()) > 0.5 || std::abs(p.y()) > 0.35 || std::abs(p.z()) > 0.1) continue;
      ++on;
      mean += p.z();
    }
    ASSERT_GT(on, 30);
    EXPECT_NEAR(mean / on, 0, 5 * 0.025 / std::sqrt(on));
  }
}

}  // namespace
}  // namespace rgbdt::simulate
