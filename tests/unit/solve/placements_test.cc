#include "calib/solve/internal/placements.h"

#include "calib/solve/first_guess.h"
#include "tests/unit/solve/joint_reports.h"

namespace rgbdt {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

Rigid3 Moved(const Rigid3& board, double by_m, double by_deg) {
  return board * Rigid3{Eigen::Quaterniond(
                            Eigen::AngleAxisd(by_deg * M_PI / 180, Eigen::Vector3d(1, 2, 2) / 3)),
                        {by_m, 0, 0}};
}

TEST(PlacementsOf, ABoardThatWasLeftWhereItStoodIsOnePlace) {
  const SolveWorld world(Views(4));
  std::vector<Rigid3> poses = world.lidar_from_target;
  EXPECT_EQ(PlacementsOf(poses).places, 4);
  EXPECT_EQ(PlacementsOf(poses).factor, 1);
  for (int again = 1; again < 6; ++again) {
    for (std::size_t v = 0; v < 4; ++v) poses.push_back(Moved(poses[v], 0.002, 0.1));
  }
  poses.back() = poses.back() * kHalfTurn;
  EXPECT_EQ(PlacementsOf(poses).places, 4);
  EXPECT_DOUBLE_EQ(PlacementsOf(poses).factor, 2.25);
}

TEST(PlacementsOf, OneThatWasMovedOrTurnedALittleIsAnother) {
  const Rigid3 board{Eigen::Quaterniond::Identity(), {3, 0, 0}};
  EXPECT_EQ(PlacementsOf({board, Moved(board, 0.02, 0)}).places, 2);
  EXPECT_EQ(PlacementsOf({board, Moved(board, 0, 0.5)}).places, 2);
  EXPECT_EQ(PlacementsOf({}).factor, 1);
}

// Three views of each of six places are worth less than three times as much as one of each.
TEST(CalibrateJointly, ViewsOfABoardThatWasNotMovedTellLittleMoreAndTheReportSaysSo) {
  const SolveWorld once(Views(6));
  SolveWorld often(Views(6));
  for (int again = 1; again < 3; ++again) {
    for (std::size_t v = 0; v < 6; ++v)
      often.AddView(Moved(often.lidar_from_target[v], 0.001, 0.02 * again));
  }
  const Report one = Calibrate(once.rig, once.detections, Brief());
  const Report many = Calibrate(often.rig, often.detections, Brief());
  for (std::size_t c = 0; c < 2; ++c) {
    const auto variance = [&](const Report& report) {
      return report.cameras[c].calibration.covariance->diagonal().sum();
    };
    EXPECT_GT(variance(many), 0.4 * variance(one));  // a third, were they all different
    EXPECT_THAT(many.cameras[c].warnings,
                Contains(HasSubstr("18 views show the board in 6 places")));
    EXPECT_THAT(one.cameras[c].warnings, Not(Contains(HasSubstr("places"))));
  }
}

}  // namespace
}  // namespace rgbdt
