#include "calib/detect/cloud/cloud_sanity.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "calib/detect/cloud/board_in_cloud.h"
#include "calib/simulate/internal/cloud_world.h"
#include "tests/simulated_variants.h"

namespace rgbdt {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class CloudSanity : public testing::TestWithParam<int> {
 protected:
  static simulate::Options Options() {
    simulate::Options options;
    if (GetParam() > 0) simulate::UseLidar(GetParam(), &options);
    return options;
  }
  // The same cloud with each point elsewhere.
  Cloud With(const std::function<Eigen::Vector3f(const Eigen::Vector3f&)>& moved) const {
    Cloud cloud = cloud_;
    for (Eigen::Vector3f& point : cloud.points) point = moved(point);
    for (Eigen::Vector3f& direction : cloud.directions) direction = moved(direction).normalized();
    return cloud;
  }

  simulate::CloudWorld world_{Options(), 0};
  Cloud cloud_ = world_.Sweep(1'000'000);
};

TEST_P(CloudSanity, ALidarsCloudIsAsItShouldBe) { EXPECT_THAT(WhyCloudIsOff(cloud_), IsEmpty()); }

TEST_P(CloudSanity, AWrongUnitIsNamed) {
  const Cloud millimetres = With([](const auto& p) { return Eigen::Vector3f(1000 * p); });
  EXPECT_THAT(WhyCloudIsOff(millimetres), HasSubstr("the millimetre"));
  EXPECT_THAT(WhyCloudIsOff(millimetres), Not(HasSubstr("e+"))) << "a plain number";
  EXPECT_THAT(FindBoards(millimetres, world_.target()).why, HasSubstr("the millimetre"));
  EXPECT_THAT(WhyCloudIsOff(With([](const auto& p) { return Eigen::Vector3f(0.001F * p); })),
              HasSubstr("kilometre"));
}

TEST_P(CloudSanity, RoundedCoordinatesAreNamed) {
  const auto rounded = [&](float step) {
    return With([&](const auto& p) -> Eigen::Vector3f {
      return (p.array() / step).round().matrix() * step;
    });
  };
  EXPECT_THAT(WhyCloudIsOff(rounded(0.01F)), HasSubstr("rounded to 10 mm"));
  EXPECT_THAT(WhyCloudIsOff(rounded(0.1F)), HasSubstr("rounded to 100 mm"));
  EXPECT_THAT(WhyCloudIsOff(rounded(0.001F)), IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(Lidars, CloudSanity, testing::Values(0, 16, 64));

using CloudAxes = CloudSanity;

TEST_P(CloudAxes, ACamerasAxesAreNamed) {
  const Cloud turned = With([](const auto& p) { return Eigen::Vector3f(-p.y(), -p.z(), p.x()); });
  EXPECT_THAT(WhyCloudIsOff(turned), HasSubstr("a camera's (x right, y down, z forward)"));
}

// In the vehicle's frame, where the LIDAR stands on the roof, nodding and turned.
TEST_P(CloudAxes, AnotherFrameIsNamedWithWhereTheLidarIsInIt) {
  const Eigen::AngleAxisf turned(0.5F, Eigen::Vector3f(0.04F, 0.12F, 1).normalized());
  const Cloud vehicles = With([&](const auto& p) -> Eigen::Vector3f {
    return turned * p + Eigen::Vector3f(0.8F, 0.1F, 1.7F);
  });
  EXPECT_THAT(WhyCloudIsOff(vehicles), AllOf(HasSubstr("meet at 0.80 0.10 1.70 m"),
                                             HasSubstr("another frame than the LIDAR's own")));
}

INSTANTIATE_TEST_SUITE_P(Spinning, CloudAxes, testing::Values(16, 64));

}  // namespace
}  // namespace rgbdt
