#include "calib/odometry/internal/registration.h"

#include <gtest/gtest.h>

namespace rgbdt::odometry {
namespace {

// What a pose that is suddenly known exactly does to the velocity, of what the prediction was off
// by.
TEST(Predict, ACorrectedPoseLeavesAVelocityThatIsLessWrongThanBefore) {
  constexpr double kSeconds = 0.1;
  Motion motion;
  motion.covariance.bottomRightCorner<6, 6>() = 1e-6 * Matrix6d::Identity();
  const Motion after = Predict(motion, kSeconds, OdometryOptions());
  for (int i = 0; i < 6; ++i) {
    // A velocity that is off by v puts the pose off by v * kSeconds, which the sweep takes back.
    const double gain = after.covariance(6 + i, i) / after.covariance(i, i);
    EXPECT_LT(std::abs(1 - gain * kSeconds), 0.6) << i;
    EXPECT_GT(gain, 0) << i;
  }
}

TEST(Predict, BackIsTheWayThatItCameAndAsUncertain) {
  Motion motion;
  motion.velocity << 0, 0, 0.3, 5, 0, 0;
  const Motion back = Predict(motion, -0.2, OdometryOptions());
  EXPECT_TRUE(Log(back.world_from_lidar * Exp(Vector6d(0.2 * motion.velocity))).isZero(1e-12));
  const Motion on = Predict(motion, 0.2, OdometryOptions());
  EXPECT_TRUE(back.covariance.diagonal().isApprox(on.covariance.diagonal(), 0.1));
}

}  // namespace
}  // namespace rgbdt::odometry
