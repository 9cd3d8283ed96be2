// What images and sweeps tell, against motions that are put in.
#include <cmath>

#include "calib/sync/internal/clock_model.h"
#include "calib/sync/internal/image_motion.h"
#include "calib/sync/internal/spline.h"
#include "calib/sync/internal/sweep_motion.h"
#include "tests/unit/matchers.h"

namespace rgbdt::sync {
namespace {

Target BoardTarget() {
  Target target;
  target.squares_x = 11;
  target.squares_y = 8;
  target.square_m = 0.1;
  target.width_m = 1.22;
  target.height_m = 0.91;
  return target;
}

CameraSpec Spec() {
  CameraSpec spec;
  spec.width = 1000;
  spec.height = 800;
  spec.lens.fx = spec.lens.fy = 700;
  spec.lens.cx = 500;
  spec.lens.cy = 400;
  spec.lens.distortion = {-0.1, 0.03, 1e-4, 2e-4, 0, 0, 0, 0};
  return spec;
}

Trajectory Waves() {
  Trajectory way{1'000'000, 0.05, {}};
  for (int i = 0; i < 60; ++i) {
    const double t = 0.05 * i;
    Rigid3 pose = RotationAbout(Eigen::Vector3d::UnitZ(), 0.4 * std::sin(3 * t)) *
                  RotationAbout(Eigen::Vector3d::UnitY(), 0.3 * std::cos(2 * t));
    Eigen::Matrix3d facing;
    facing << 0, 0, 1, -1, 0, 0, 0, -1, 0;
    pose.rotation = pose.rotation * Eigen::Quaterniond(facing);
    pose.translation = {3 + 0.3 * std::sin(2.5 * t), 0.4 * std::cos(2 * t), 0.1};
    way.knots.push_back(pose);
  }
  return way;
}

TEST(SplineTest, GoesOnSmoothlyFromSegmentToSegment) {
  const Trajectory way = Waves();
  for (const double t : {0.5, 1.0, 1.35}) {
    const Vector6d apart = Log(way.At(t + 1e-9) * way.At(t - 1e-9).Inverse());
    EXPECT_LT(apart.norm(), 1e-6);
    EXPECT_LT((way.TwistAt(t + 1e-7) - way.TwistAt(t - 1e-7)).norm(), 1e-4);
  }
}

TEST(SplineTest, TwistIsTheWaysSlope) {
  const Trajectory way = Waves();
  const double t = 0.73;
  const double h = 1e-4;
  const Vector6d slope = Log(way.At(t + h) * way.At(t - h).Inverse()) / (2 * h);
  EXPECT_LT((way.TwistAt(t) - slope).norm(), 1e-3 * slope.norm());
}

TEST(LineariseImageTest, TellsThePoseAndItsChangeByRow) {
  const Target target = BoardTarget();
  const Camera camera(Spec());
  const Rigid3 predicted{RotationAbout(Eigen::Vector3d(1, 0.3, 0.1).normalized(), 0.3).rotation,
                         {0.1, -0.1, 3}};
  Vector6d moved;
  Vector6d by_row;
  moved << 2e-4, -3e-4, 1e-4, 1e-3, -5e-4, 8e-4;
  by_row << 5e-3, -3e-3, 6e-3, 0.01, 0.02, -0.01;
  PosedImage image;
  const auto place = [&](const Eigen::Vector3d& corner, double later) {
    return *camera.Project(Exp(later * by_row) * (Exp(moved) * (predicted * corner)));
  };
  for (const Eigen::Vector3d& corner : target.InnerCorners()) {
    Eigen::Vector2d pixel = place(corner, 0);
    for (int k = 0; k < 5; ++k) pixel = place(corner, RowShare(pixel.y(), camera.height()));
    image.corners.push_back(pixel);
  }
  const Quadratic quadratic =
      LineariseImage(camera, target, image, 0.1, [&](double) { return predicted; });
  Quadratic::Vector truth;
  truth << moved, by_row, 0;
  EXPECT_GT(quadratic.rest.norm(), 10);
  EXPECT_LT((quadratic.root * truth + quadratic.rest).norm(), 0.02 * quadratic.rest.norm());
  // A board that comes nearer from row to row looks tilted: that alone is not told.
  EXPECT_EQ(quadratic.rank, 11);
  // About the truth nothing is left.
  const Quadratic there = LineariseImage(camera, target, image, 0.1, [&](double later) {
    return Exp(later * by_row) * Exp(moved) * predicted;
  });
  EXPECT_LT(there.rest.norm(), 1e-3);
  EXPECT_LT(there.misfit, 1e-6);
}

// A wave that turns about within the read-out: taken as straight, its slope would seem smaller.
TEST(LineariseImageTest, AMotionThatIsNotStraightLeavesNothing) {
  const Target target = BoardTarget();
  const Camera camera(Spec());
  const Trajectory way = Waves();
  Eigen::Matrix3d looking;  // along the LIDAR's x
  looking << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  const Rigid3 camera_from_lidar{Eigen::Quaterniond(looking), {0, 0, 0}};
  constexpr double kSeconds = 1.2, kRolling = 0.3;
  const auto at = [&](double later) {
    return camera_from_lidar * way.At(kSeconds + later * kRolling);
  };
  PosedImage image;
  for (const Eigen::Vector3d& corner : target.InnerCorners()) {
    Eigen::Vector2d pixel = *camera.Project(at(0) * corner);
    for (int k = 0; k < 20; ++k) {
      pixel = *camera.Project(at(RowShare(pixel.y(), camera.height())) * corner);
    }
    image.corners.push_back(pixel);
  }
  const Quadratic there = LineariseImage(camera, target, image, 0.1, at);
  EXPECT_LT(there.rest.norm(), 1e-3);
  const Rigid3 middle = at(0);
  const Vector6d by_row = kRolling * (Adjoint(camera_from_lidar) * way.TwistAt(kSeconds));
  const Quadratic straight = LineariseImage(
      camera, target, image, 0.1, [&](double later) { return Exp(later * by_row) * middle; });
  EXPECT_GT(straight.rest.norm(), 1);
}

TEST(LineariseSweepTest, FindsWhatAPlaneTells) {
  const Target target = BoardTarget();
  const Trajectory way = Waves();
  // The board is nearer by 4 mm along its normal than the way has it, moving as it says.
  WavedSweep sweep;
  for (double azimuth = -0.4; azimuth < 0.4; azimuth += 0.004) {
    const double seconds = 1.0 + azimuth / (20 * M_PI);
    const Rigid3 pose = way.At(seconds) * Rigid3{Eigen::Quaterniond::Identity(), {0, 0, -0.004}};
    for (double elevation = -0.3; elevation < 0.3; elevation += 0.02) {
      const Eigen::Vector3d beam(std::cos(elevation) * std::cos(azimuth),
                                 std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
      const auto met = MeetBoard(pose, beam);
      if (!met || !IsOn(target, met->place, 0)) continue;
      sweep.points.push_back((met->range * beam).cast<float>());
      sweep.utime.push_back(way.start + FromSeconds(seconds));
    }
  }
  const auto motion = LineariseSweep(sweep, target, way, 0, {});
  ASSERT_TRUE(motion);
  Quadratic::Vector truth = Quadratic::Vector::Zero();
  truth.segment<3>(3) = motion->lidar_from_target.rotation * Eigen::Vector3d(0, 0, -0.004);
  const Eigen::VectorXd off = motion->quadratic.root * truth + motion->quadratic.rest;
  EXPECT_GT(motion->quadratic.rest.norm(), 5);  // it is seen that the board is elsewhere
  EXPECT_LT(off.norm(), 0.2);                   // and that is where it is
}

OffsetsOverTime Offsets(const std::vector<double>& values, double sigma) {
  const auto count = static_cast<Eigen::Index>(values.size());
  return {Eigen::VectorXd::LinSpaced(count, 0, 2 * static_cast<double>(count - 1)),
          Eigen::Map<const Eigen::VectorXd>(values.data(), count),
          Eigen::MatrixXd::Identity(count, count) * sigma * sigma};
}

TEST(ClockModelTest, TellsAJumpFromADrift) {
  const ClockModel constant = FitClock(Offsets({1e-4, -1e-4, 5e-5, -1e-4, 1e-4, 0}, 1e-4));
  EXPECT_FALSE(constant.drift || constant.jump || constant.wanders);
  const ClockModel drifts = FitClock(Offsets({0, 4e-4, 8e-4, 1.2e-3, 1.6e-3, 2e-3}, 1e-4));
  ASSERT_TRUE(drifts.drift);
  EXPECT_NEAR(drifts.drift->value, 2e-4, 1e-9);
  EXPECT_FALSE(drifts.jump);
  const ClockModel jumps = FitClock(Offsets({0, 1e-4, 0, 0, 2e-3, 2.1e-3, 2e-3, 2e-3}, 1e-4));
  ASSERT_TRUE(jumps.jump);
  EXPECT_NEAR(jumps.jump->seconds, 7, 1.1);
  EXPECT_NEAR(jumps.jump->by_s.value, 2e-3, 1e-4);
  EXPECT_FALSE(jumps.drift);
  OffsetsOverTime gap = Offsets({0, 4e-4, 1.6e-3, 2e-3}, 1e-4);  // as above, less two of them
  gap.seconds << 0, 2, 8, 10;
  ASSERT_TRUE(FitClock(gap).drift);
  EXPECT_NEAR(FitClock(gap).drift->value, 2e-4, 1e-9);
  EXPECT_TRUE(FitClock(Offsets({0, 2e-3, 0, 2e-3, 0, 2e-3, 0, 2e-3}, 1e-4)).wanders);
}

}  // namespace
}  // namespace rgbdt::sync
