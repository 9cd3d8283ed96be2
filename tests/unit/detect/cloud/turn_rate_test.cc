#include "calib/detect/cloud/turn_rate.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <vector>

#include "calib/scan_assembly/line_to_cloud.h"
#include "calib/scan_assembly/sweep_chunks.h"

namespace rgbdt {
namespace {

// Lines over the vertical, straight ahead and behind, 20 ms apart; the motor's angle at a time. All
// beams of the lower half return nothing.
template <typename Angle>
Cloud Sweep(int lines, const Angle& angle) {
  TurnedScanner scanner;
  scanner.motor_from_scanner = {Eigen::Quaterniond(0.999, 0.01, -0.03, 0.02).normalized(),
                                {0.05, -0.02, 0.1}};
  std::vector<CloudChunk> chunks;
  for (int i = 0; i < lines; ++i) {
    LineScan line;
    line.utime = 1'000'000 + 20'000 * i;
    line.beam_period_s = 4e-5;
    line.first_angle_rad = -0.8;
    line.angle_step_rad = 0.008;
    std::vector<double> angles;
    for (int beam = 0; beam < 500; ++beam) {
      line.range.push_back(beam % 3 == 0 ? NAN : 3.0F + 0.01F * static_cast<float>(beam));
      line.intensity.push_back(0.5F);
      angles.push_back(angle(0.02 * i + 4e-5 * beam));
    }
    CloudChunk& chunk = chunks.emplace_back();
    chunk.cloud = LineToCloud(scanner, line, angles);
    chunk.cloud.first_line = i;
  }
  return JoinChunks(chunks);
}

TEST(TurnRate, HasItsSignAndSize) {
  for (const double rate : {0.1, -0.1, 0.6, -0.02}) {
    const Cloud cloud = Sweep(200, [&](double t) { return rate * (t - 2); });
    EXPECT_NEAR(TurnRate(cloud, {3, 0, 0.5}), rate, 1e-3 * std::abs(rate));
    Cloud of_hits = cloud;
    of_hits.directions.clear();
    EXPECT_NEAR(TurnRate(of_hits, {3, 0, 0.5}), rate, 1e-3 * std::abs(rate));
  }
}

TEST(TurnRate, IsThatWhereTheBoardIs) {
  // It speeds up: 0.05 rad/s at the start, 0.35 rad/s at the end.
  const Cloud cloud = Sweep(200, [](double t) { return 0.05 * t + 0.0375 * t * t; });
  const double at_2_s = 0.05 * 2 + 0.0375 * 4;
  EXPECT_NEAR(TurnRate(cloud, {std::cos(at_2_s), std::sin(at_2_s), 0}), 0.2, 0.02);
}

TEST(TurnRate, IsNoneWhereTheCloudDoesNotTell) {
  const auto still = [](double) { return 0.3; };
  EXPECT_NEAR(TurnRate(Sweep(50, still), {1, 0.3, 0}), 0, 1e-6);
  Cloud cloud = Sweep(50, [](double t) { return 0.1 * t; });
  EXPECT_EQ(TurnRate(cloud, {-1, -3, 0}), 0);  // nothing was scanned there
  Cloud untimed = cloud;
  untimed.utime.clear();
  EXPECT_EQ(TurnRate(untimed, {1, 0, 0}), 0);
  cloud.organised = false;
  EXPECT_EQ(TurnRate(cloud, {1, 0, 0}), 0);
}

}  // namespace
}  // namespace rgbdt
