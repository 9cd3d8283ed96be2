#include "calib/map/voxel_map.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>

#include "tests/unit/matchers.h"

namespace rgbdt {
namespace {

using ::testing::HasSubstr;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr Utime kNow = 1'700'000'000'123'457;

RgbdtCloud CloudOf(const std::vector<Eigen::Vector3f>& points, Utime utime = kNow) {
  RgbdtCloud cloud;
  cloud.points = points;
  cloud.sweep_utime = utime;
  cloud.utime.assign(points.size(), utime);
  cloud.rgb.assign(points.size(), {0, 0, 0});
  cloud.temperature_k.assign(points.size(), kNan);
  cloud.temperature_sigma_k.assign(points.size(), kNan);
  return cloud;
}

VoxelMapOptions Options(double voxel_m, std::size_t max_voxels = 1000) {
  VoxelMapOptions options;
  options.voxel_m = voxel_m;
  options.max_voxels = max_voxels;
  return options;
}

bool SameBits(const MapCloud& a, const MapCloud& b) {
  const auto same = [](const auto& x, const auto& y) {
    return x.size() == y.size() && std::memcmp(x.data(), y.data(), x.size() * sizeof x[0]) == 0;
  };
  return same(a.points, b.points) && same(a.rgb, b.rgb) && same(a.temperature_k, b.temperature_k) &&
         same(a.count, b.count) && same(a.last_seen, b.last_seen);
}

TEST(VoxelMap, MeansOfWhatIsKnown) {
  VoxelMap map(Options(1));
  RgbdtCloud cloud = CloudOf({{0.2F, 0.2F, -0.2F}, {0.4F, 0.6F, -0.6F}, {0.9F, 0.1F, -0.1F}});
  cloud.rgb = {{{10, 20, 30}, {0, 0, 0}, {30, 60, 90}}};
  cloud.temperature_k = {300, 310, kNan};
  cloud.temperature_sigma_k = {1, 0.5F, kNan};
  cloud.utime = {kNow, kNow + 7, kNow + 3};
  map.Add(cloud);
  const MapCloud voxels = map.Cloud();
  ASSERT_EQ(voxels.size(), 1U);
  EXPECT_THAT(voxels.points[0], EigenNear(Eigen::Vector3f(0.5F, 0.3F, -0.3F), 1e-6F));
  EXPECT_EQ(voxels.rgb[0], (std::array<std::uint8_t, 3>{20, 40, 60}));
  EXPECT_NEAR(voxels.temperature_k[0], 308, 1e-3) << "weights 1 and 4";
  EXPECT_EQ(voxels.count[0], 3U);
  EXPECT_EQ(voxels.last_seen[0], kNow + 7);
  EXPECT_EQ(voxels.frame, "lidar");
}

TEST(VoxelMap, WhatNoCameraSawStaysUnknown) {
  VoxelMap map(Options(1));
  map.Add(CloudOf({{0.2F, 0.2F, 0.2F}}));
  EXPECT_TRUE(std::isnan(map.Cloud().temperature_k[0]));
  EXPECT_EQ(map.Cloud().rgb[0], (std::array<std::uint8_t, 3>{0, 0, 0}));
}

TEST(VoxelMap, PointsGoByThePose) {
  VoxelMap map(Options(0.1));
  RgbdtCloud cloud = CloudOf({{1, 0, 0}});
  cloud.map_from_lidar = RotationAbout(Eigen::Vector3d::UnitZ(), M_PI / 2);
  cloud.map_from_lidar->translation = {10.03, 20.02, 3.01};
  map.Add(cloud);
  EXPECT_THAT(map.Cloud().points.at(0), EigenNear(Eigen::Vector3f(10.03F, 21.02F, 3.01F), 1e-5F));
  EXPECT_EQ(map.Cloud().frame, "map");
}

TEST(VoxelMap, PosedAndUnposedCloudsDoNotMix) {
  VoxelMap map(Options(0.1));
  RgbdtCloud posed = CloudOf({{1, 0, 0}});
  posed.map_from_lidar = Rigid3();
  map.Add(CloudOf({}));  // a sweep's end says nothing
  map.Add(posed);
  EXPECT_THAT(InputErrorOf([&] { map.Add(CloudOf({{2, 0, 0}})); }), HasSubstr("pose"));
  EXPECT_EQ(map.size(), 1U);
  map.Add(CloudOf({}));
  VoxelMap other(Options(0.1));
  other.Add(CloudOf({{2, 0, 0}}));
  EXPECT_THAT(InputErrorOf([&] { other.Add(posed); }), HasSubstr("LIDAR frame"));
}

TEST(VoxelMap, WhatWasNotSeenForTheLongestGoesFirst) {
  VoxelMap map(Options(1, 3));
  for (int i = 0; i < 3; ++i) map.Add(CloudOf({{i + 0.5F, 0.5F, 0.5F}}, kNow + i));
  map.Add(CloudOf({{0.6F, 0.5F, 0.5F}}, kNow + 10));  // the first again
  map.Add(CloudOf({{1.5F, 0.5F, 0.5F}}, kNow - 10));  // late news of the second does not help it
  map.Add(CloudOf({{7.5F, 0.5F, 0.5F}}, kNow + 11));
  EXPECT_EQ(map.evicted(), 1);
  const MapCloud voxels = map.Cloud();
  ASSERT_EQ(voxels.size(), 3U);
  EXPECT_FLOAT_EQ(voxels.points[0].x(), 0.55F);
  EXPECT_FLOAT_EQ(voxels.points[1].x(), 2.5F);
  EXPECT_FLOAT_EQ(voxels.points[2].x(), 7.5F);
}

TEST(VoxelMap, AMapOfOneVoxel) {
  VoxelMap map(Options(1, 1));
  for (int i = 0; i < 100; ++i) map.Add(CloudOf({{i + 0.5F, 0, 0}, {i + 0.7F, 0, 0}}));
  ASSERT_EQ(map.size(), 1U);
  EXPECT_EQ(map.evicted(), 99);
  EXPECT_EQ(map.Cloud().count[0], 2U);
  EXPECT_FLOAT_EQ(map.Cloud().points[0].x(), 99.6F);
}

// A full map against one that forgets by looking at every voxel.
TEST(VoxelMap, ForgetsAsASlowMapDoes) {
  Random random(5);
  VoxelMap map(Options(1, 50));
  std::map<std::array<int, 3>, int> last;  // when touched
  for (int i = 0; i < 20000; ++i) {
    const std::array<int, 3> place = {static_cast<int>(random.Uniform(-6, 6)),
                                      static_cast<int>(random.Uniform(-4, 4)),
                                      static_cast<int>(random.Uniform(-2, 2))};
    map.Add(CloudOf({{place[0] + 0.5F, place[1] + 0.5F, place[2] + 0.5F}}, kNow + i));
    if (last.count(place) == 0 && last.size() == 50) {
      last.erase(std::min_element(last.begin(), last.end(), [](const auto& a, const auto& b) {
        return a.second < b.second;
      }));
    }
    last[place] = i;
  }
  const MapCloud voxels = map.Cloud();
  ASSERT_EQ(voxels.size(), last.size());
  std::size_t at = 0;
  for (const auto& [place, touched] : last) {  // both sorted by x, y, z
    EXPECT_FLOAT_EQ(voxels.points[at].x(), static_cast<float>(place[0]) + 0.5F);
    EXPECT_FLOAT_EQ(voxels.points[at].y(), static_cast<float>(place[1]) + 0.5F);
    EXPECT_EQ(voxels.last_seen[at], kNow + touched);
    ++at;
  }
}

TEST(VoxelMap, PointsThatCannotBePlacedAreSkippedAndCounted) {
  VoxelMap map(Options(0.001));
  const float inf = std::numeric_limits<float>::infinity();
  map.Add(
      CloudOf({{kNan, 0, 0}, {0, inf, 0}, {0, 0, -inf}, {2000, 0, 0}, {0, -1e38F, 0}, {1, 1, 1}}));
  EXPECT_EQ(map.skipped(), 5);
  EXPECT_EQ(map.points(), 1);
  EXPECT_EQ(map.size(), 1U);
}

TEST(VoxelMap, TheSameCloudsGiveTheSameBits) {
  const auto run = [] {
    Random random(9);
    VoxelMap map(Options(0.5, 300));
    for (int i = 0; i < 50; ++i) {
      RgbdtCloud cloud = CloudOf({});
      for (int k = 0; k < 100; ++k) {
        cloud.points.emplace_back((5 * random.Direction()).cast<float>());
        cloud.temperature_k.push_back(static_cast<float>(random.Uniform(280, 310)));
        cloud.utime.push_back(kNow + 100 * i + k);
      }
      cloud.temperature_sigma_k.clear();
      cloud.rgb.clear();
      map.Add(cloud);
    }
    return map.Cloud();
  };
  EXPECT_TRUE(SameBits(run(), run()));
}

TEST(VoxelMap, BadInputIsRefusedWithItsValues) {
  EXPECT_THAT(InputErrorOf([] { VoxelMap map(Options(-1)); }), HasSubstr("-1"));
  EXPECT_THAT(InputErrorOf([] { VoxelMap map(Options(std::nan(""))); }), HasSubstr("voxel_m"));
  EXPECT_THAT(InputErrorOf([] { VoxelMap map(Options(1, 0)); }), HasSubstr("max_voxels is 0"));
  VoxelMap map(Options(1));
  RgbdtCloud cloud = CloudOf({{1, 1, 1}, {2, 2, 2}});
  cloud.rgb.pop_back();
  EXPECT_THAT(InputErrorOf([&] { map.Add(cloud); }),
              testing::AllOf(HasSubstr("2 points"), HasSubstr("1 values of rgb")));
  EXPECT_EQ(map.size(), 0U);
}

}  // namespace
}  // namespace rgbdt
