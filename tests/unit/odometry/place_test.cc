// Places by sweeps of rays through a street: the simulator shares no code with the descriptor.
#include "calib/odometry/internal/place.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/numbers.h"
#include "tests/study/drives.h"

namespace rgbdt {
namespace {

// Seen from where the LIDAR stands, looking `yaw` to the left of along the street.
odometry::Place Seen(double along, double aside, double yaw, std::uint64_t street = 4) {
  simulate::SpinningOptions lidar = simulate::SpinningLidar(32);
  lidar.azimuth_step_rad *= 4;
  Rigid3 pose = RotationAbout(Eigen::Vector3d::UnitZ(), yaw);
  pose.translation = {along, aside, 0};
  study::Drive drive(study::DriveScene::kStreet, street, lidar, [pose](double) { return pose; });
  const Cloud sweep = drive.Sweep(0);
  std::vector<Eigen::Vector3d> points;
  for (const Eigen::Vector3f& p : sweep.points) {
    if (p.allFinite()) points.emplace_back(p.cast<double>());
  }
  return odometry::PlaceOf(points).value();
}

double WrappedTo(double angle) { return std::remainder(angle, 2 * M_PI); }

TEST(Place, IsKnownAgainWhicheverWayTheLidarLooks) {
  for (const double along : {20.0, 60.0}) {
    const odometry::Place first = Seen(along, 0, 0);
    for (const double yaw : {0.0, 90 * kDegree, 180 * kDegree}) {
      const auto again = Compare(first, Seen(along + 0.8, 0.6, yaw));
      // A sector is 6 degrees wide.
      EXPECT_LT(std::abs(WrappedTo(again.yaw_rad - yaw)), 6.1 * kDegree) << along << ' ' << yaw;
      for (const double elsewhere : {along + 33, along + 57}) {
        EXPECT_LT(again.value, Compare(first, Seen(elsewhere, 0, yaw)).value)
            << along << ' ' << yaw << ' ' << elsewhere;
      }
    }
  }
}

TEST(Place, AnotherStreetIsAnotherPlace) {
  const odometry::Place here = Seen(20, 0, 0);
  EXPECT_LT(Compare(here, Seen(20.5, 0, 0)).value + 0.05, Compare(here, Seen(20, 0, 0, 5)).value);
}

TEST(Place, FewPointsAreNoPlace) {
  EXPECT_FALSE(odometry::PlaceOf({{1, 2, 3}, {4, 5, 6}}));
  // Only ground: nothing that another place could be like.
  std::vector<Eigen::Vector3d> ground;
  for (int x = -20; x < 20; ++x) {
    for (int y = -20; y < 20; ++y) ground.emplace_back(x, y, -1.5);
  }
  const auto place = odometry::PlaceOf(ground);
  ASSERT_TRUE(place);
  EXPECT_EQ(Compare(*place, *place).value, 1);
}

}  // namespace
}  // namespace rgbdt
