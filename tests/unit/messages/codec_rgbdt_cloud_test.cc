#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "services/messages/codec.h"
#include "services/messages/internal/codec_types.h"
#include "tests/unit/messages/codec_testing.h"
#include "tests/unit/messages/random_messages.h"

namespace rgbdt {
namespace {

using testing::ErrorAfter;
using testing::ErrorOf;
using testing::ExpectSameRigid;
using ::testing::HasSubstr;
using testing::RandomMessages;
using testing::ThroughTheWire;

constexpr int kCloudRounds = 100;

// The same numbers, a NaN for a NaN.
void ExpectSame(const std::vector<float>& a, const std::vector<float>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_TRUE(a[i] == b[i] || (std::isnan(a[i]) && std::isnan(b[i]))) << a[i] << " " << b[i];
  }
}

class RgbdtCloudOnTheWire : public ::testing::Test {
 protected:
  /// With three points at least and a pose.
  RgbdtCloud Whole() {
    RgbdtCloud cloud = random_.Fused();
    while (cloud.size() < 3) cloud = random_.Fused();
    cloud.map_from_lidar = random_.Rigid();
    cloud.frame_utime = random_.Time();
    return cloud;
  }

  RandomMessages random_{5};
};

TEST_F(RgbdtCloudOnTheWire, ComesBackWhole) {
  for (int round = 0; round < kCloudRounds; ++round) {
    const RgbdtCloud a = random_.Fused();
    const RgbdtCloud b = ThroughTheWire(a);
    EXPECT_EQ(a.seq, b.seq);
    EXPECT_EQ(a.sweep_utime, b.sweep_utime);
    EXPECT_EQ(a.sweep_end, b.sweep_end);
    EXPECT_EQ(a.whole_sweep, b.whole_sweep);
    EXPECT_EQ(a.cameras, b.cameras);
    EXPECT_EQ(a.calibration_utime, b.calibration_utime);
    EXPECT_EQ(a.frame_utime, b.frame_utime);
    ASSERT_EQ(a.map_from_lidar.has_value(), b.map_from_lidar.has_value());
    if (a.map_from_lidar) ExpectSameRigid(*a.map_from_lidar, *b.map_from_lidar);
    EXPECT_EQ(a.points, b.points);
    ExpectSame(a.intensity, b.intensity);
    EXPECT_EQ(a.utime, b.utime);
    EXPECT_EQ(a.rgb, b.rgb);
    ExpectSame(a.temperature_k, b.temperature_k);
    ExpectSame(a.temperature_sigma_k, b.temperature_sigma_k);
    ExpectSame(a.thermal_counts, b.thermal_counts);
    EXPECT_EQ(a.valid, b.valid);
  }
}

TEST_F(RgbdtCloudOnTheWire, AChunkAndASweepHaveTheirOwnChannels) {
  RgbdtCloud cloud = random_.Fused();
  cloud.whole_sweep = false;
  EXPECT_EQ(ChannelOf(cloud), "RGBDT_CLOUD");
  const Bytes chunk = Encode(cloud);
  EXPECT_THAT(ErrorOf([&] { Decode("RGBDT_SWEEP", chunk.data(), chunk.size()); }),
              HasSubstr("belongs on channel RGBDT_CLOUD"));
  cloud.whole_sweep = true;
  EXPECT_EQ(ChannelOf(cloud), "RGBDT_SWEEP");
  const Bytes sweep = Encode(cloud);
  EXPECT_THAT(ErrorOf([&] { Decode("RGBDT_CLOUD", sweep.data(), sweep.size()); }),
              HasSubstr("belongs on channel RGBDT_SWEEP"));
}

TEST_F(RgbdtCloudOnTheWire, HoldsAsManyPointsAsItsTypeSays) {
  RgbdtCloud cloud = random_.Fused();
  const auto resize = [&](std::size_t size) {
    cloud.points.resize(size, {1, 2, 3});
    cloud.intensity.resize(size);
    cloud.utime.resize(size, 1'600'000'000'000'000);
    cloud.rgb.resize(size);
    cloud.temperature_k.resize(size);
    cloud.temperature_sigma_k.resize(size);
    cloud.thermal_counts.resize(size);
    cloud.valid.resize(size);
  };
  resize(80'000);
  EXPECT_EQ(ThroughTheWire(cloud).size(), 80'000U);
  resize(81'000);
  EXPECT_THAT(ErrorOf([&] { Encode(cloud); }), HasSubstr("send a cloud in chunks"));
}

TEST_F(RgbdtCloudOnTheWire, BadPoints) {
  const RgbdtCloud cloud = Whole();
  const auto error = [&](auto change) { return ErrorAfter<rgbdt_cloud_t>(cloud, change); };
  EXPECT_EQ(error([](auto&) {}), "no error");
  EXPECT_THAT(error([](auto& w) { w.z_m[2] = NAN; }), HasSubstr("point[2]"));
  EXPECT_THAT(error([](auto& w) { w.x_m[1] = -INFINITY; }), HasSubstr("point[1] is (-inf"));
  EXPECT_THAT(error([](auto& w) { w.y_m[0] = 2e6; }), HasSubstr("point[0]"));
  EXPECT_THAT(error([](auto& w) { w.valid[1] = 4; }), HasSubstr("valid[1] is 4"));
  EXPECT_THAT(error([](auto& w) { w.valid[1] = -1; }), HasSubstr("valid[1] is -1"));
  EXPECT_THAT(error([](auto& w) { w.intensity[2] = 1.5; }), HasSubstr("intensity[2] is 1.5"));
  EXPECT_THAT(error([](auto& w) { w.intensity[0] = -1; }), HasSubstr("intensity[0] is -1"));
  EXPECT_THAT(error([](auto& w) { w.temperature_k[0] = -3; }), HasSubstr("temperature_k[0] is -3"));
  EXPECT_THAT(error([](auto& w) { w.temperature_k[1] = INFINITY; }),
              HasSubstr("temperature_k[1] is inf"));
  EXPECT_THAT(error([](auto& w) { w.thermal_counts[2] = -INFINITY; }),
              HasSubstr("thermal_counts[2] is -inf"));
  EXPECT_THAT(error([](auto& w) { w.utime = 5, w.utime_offset_us.assign(w.x_m.size(), -4); }),
              "no error");
  EXPECT_THAT(error([](auto& w) { w.utime = 5, w.utime_offset_us.assign(w.x_m.size(), -5); }),
              HasSubstr("utime_offset_us[0] is -5"));
  EXPECT_THAT(error([](auto& w) { w.temperature_sigma_k[2] = -0.5F; }),
              HasSubstr("temperature_sigma_k[2] is -0.5"));
  EXPECT_THAT(error([](auto& w) { w.temperature_sigma_k[0] = INFINITY; }),
              HasSubstr("temperature_sigma_k[0] is inf"));
  EXPECT_EQ(error([](auto& w) { w.temperature_sigma_k[0] = NAN; }), "no error");
}

TEST_F(RgbdtCloudOnTheWire, BadCameras) {
  const RgbdtCloud cloud = Whole();
  const auto error = [&](auto change) { return ErrorAfter<rgbdt_cloud_t>(cloud, change); };
  const auto resize = [](int size, auto& w) {
    w.num_cameras = size;
    w.camera.resize(static_cast<std::size_t>(size), "rgb");
    w.calibration_utime.resize(static_cast<std::size_t>(size));
  };
  EXPECT_EQ(error([&](auto& w) { resize(32, w); }), "no error");
  EXPECT_THAT(error([&](auto& w) { resize(33, w); }), HasSubstr("num_cameras is 33"));
  EXPECT_THAT(error([](auto& w) { w.camera[1] = "RGB"; }), HasSubstr("camera[1] is"));
  EXPECT_THAT(error([](auto& w) { w.calibration_utime[1] = -1; }),
              HasSubstr("calibration_utime[1] is -1"));
  EXPECT_THAT(error([](auto& w) { w.calibration_utime[0] = std::int64_t{1} << 60; }),
              HasSubstr("calibration_utime[0] is"));
}

TEST_F(RgbdtCloudOnTheWire, BadPoses) {
  const RgbdtCloud cloud = Whole();
  const auto error = [&](auto change) { return ErrorAfter<rgbdt_cloud_t>(cloud, change); };
  EXPECT_THAT(error([](auto& w) { w.frame_utime = 0; }), HasSubstr("frame_utime is 0"));
  EXPECT_THAT(error([](auto& w) { w.quaternion_wxyz[0] += 0.1; }), HasSubstr("norm of quaternion"));
  EXPECT_THAT(error([](auto& w) { w.quaternion_wxyz[3] = NAN; }), HasSubstr("quaternion_wxyz[3]"));
  EXPECT_THAT(error([](auto& w) { w.translation_m[1] = INFINITY; }), HasSubstr("translation_m[1]"));
  // What is not there is not read.
  EXPECT_EQ(error([](auto& w) { w.has_pose = 0, w.frame_utime = -1, w.translation_m[1] = NAN; }),
            "no error");
}

TEST_F(RgbdtCloudOnTheWire, WhatDoesNotFitTogetherIsRefusedWhereItWasMade) {
  const RgbdtCloud good = Whole();
  const auto error = [&](auto change) {
    RgbdtCloud cloud = good;
    change(cloud);
    return ErrorOf([&] { Encode(cloud); });
  };
  EXPECT_THAT(error([](auto& c) { c.valid.pop_back(); }), HasSubstr("length of valid"));
  EXPECT_THAT(error([](auto& c) { c.temperature_sigma_k.pop_back(); }),
              HasSubstr("length of temperature_sigma_k"));
  EXPECT_THAT(error([](auto& c) { c.calibration_utime.pop_back(); }),
              HasSubstr("length of calibration_utime is 1; expected 2"));
  EXPECT_THAT(error([](auto& c) { c.utime[1] = 0; }), HasSubstr("utime is 0"));
  EXPECT_THAT(error([](auto& c) { c.utime[1] += std::int64_t{1} << 31; }),
              HasSubstr("utime_offset_us is"));
}

}  // namespace
}  // namespace rgbdt
