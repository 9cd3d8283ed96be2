#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "services/messages/codec.h"
#include "services/messages/internal/codec_types.h"
#include "tests/unit/messages/codec_testing.h"
#include "tests/unit/messages/random_messages.h"

namespace rgbdt {
namespace {

using ::testing::AllOf;
using testing::ErrorAfter;
using testing::ErrorOf;
using ::testing::HasSubstr;
using testing::kNan;
using testing::RandomMessages;

class Invalid : public ::testing::Test {
 protected:
  RandomMessages random_{7};
};

TEST_F(Invalid, UnknownChannel) {
  const Bytes bytes(100);
  for (const char* channel : {"", "CLOUDS", "_IMAGE", "cloud", "IMAGE", "LCM_SELF_TEST"}) {
    EXPECT_THAT(ErrorOf([&] { Decode(channel, bytes.data(), bytes.size()); }),
                HasSubstr("no message type belongs to channel"));
  }
}

TEST_F(Invalid, AnotherType) {
  const Bytes bytes = Encode(random_.Line());
  EXPECT_THAT(ErrorOf([&] { Decode("CLOUD", bytes.data(), bytes.size()); }),
              HasSubstr("no cloud_t: another type or version on channel CLOUD"));
}

TEST_F(Invalid, AnotherCamera) {
  Image image = random_.Picture();
  image.camera = "rgb";
  const Bytes bytes = Encode(image);
  EXPECT_THAT(ErrorOf([&] { Decode("THERMAL_IMAGE", bytes.data(), bytes.size()); }),
              HasSubstr("belongs on channel RGB_IMAGE"));
}

TEST_F(Invalid, AboveThreeMegabytes) {
  ReportText report;
  report.json.assign(3 * 1024 * 1024 - 100, 'x');
  EXPECT_EQ(ErrorOf([&] { Encode(report); }), "no error");
  report.json.assign(3 * 1024 * 1024 - 10, 'x');
  EXPECT_THAT(ErrorOf([&] { Encode(report); }), HasSubstr("the bus carries 3145728"));
  Image image = random_.Picture(PixelFormat::kBgr8);
  image.pixels.create(1456, 1936, CV_8UC3);
  EXPECT_THAT(ErrorOf([&] { Encode(image); }), HasSubstr("send raw Bayer"));
  RgbdtCloud cloud;
  cloud.points.resize(4'000'000);
  EXPECT_NE(ErrorOf([&] { Encode(cloud); }), "no error");
  const Bytes bytes(3 * 1024 * 1024 + 1);
  EXPECT_THAT(ErrorOf([&] { Decode("CLOUD", bytes.data(), bytes.size()); }),
              HasSubstr("3145729 bytes"));
}

TEST_F(Invalid, LineScan) {
  LineScan line = random_.Line();
  line.range = {1, kNan, 2};
  line.intensity = {0, kNan, 1};
  const auto error = [&](auto change) { return ErrorAfter<line_scan_t>(line, change); };
  EXPECT_THAT(error([](auto& w) { w.range_m[2] = INFINITY; }), HasSubstr("range_m[2] is inf"));
  EXPECT_THAT(error([](auto& w) { w.range_m[0] = 0; }), HasSubstr("range_m[0] is 0"));
  EXPECT_THAT(error([](auto& w) { w.intensity[2] = 200; }), HasSubstr("intensity[2] is 200"));
  EXPECT_THAT(error([](auto& w) { w.angle_step_rad = NAN; }), HasSubstr("angle_step_rad is nan"));
  EXPECT_THAT(error([](auto& w) { w.beam_period_s = 1e300; }),
              HasSubstr("beam_period_s is 1e+300"));
  EXPECT_THAT(error([](auto& w) { w.utime = 0; }), HasSubstr("utime is 0"));
  EXPECT_THAT(error([](auto& w) { w.utime = std::int64_t{1} << 60; }), HasSubstr("utime is"));
  EXPECT_THAT(error([](auto& w) { w.seq = -2; }), HasSubstr("seq is -2"));
  line.intensity.resize(2);
  EXPECT_THAT(ErrorOf([&] { Encode(line); }), HasSubstr("length of intensity is 2; expected 3"));
}

TEST_F(Invalid, Image) {
  Image image = random_.Picture(PixelFormat::kMono16);
  image.radiometry.kind = Radiometry::Kind::kPlanck;
  image.radiometry.r = image.radiometry.b = 1;
  const auto error = [&](auto change) { return ErrorAfter<image_t>(image, change); };
  EXPECT_THAT(error([](auto& w) { w.width = 0; }), HasSubstr("width is 0"));
  EXPECT_THAT(error([](auto& w) { w.height = 20001; }), HasSubstr("height is 20001"));
  EXPECT_THAT(error([](auto& w) { w.stride -= 1; }), HasSubstr("stride"));
  EXPECT_THAT(error([](auto& w) { w.stride = 0; }), HasSubstr("stride"));
  EXPECT_THAT(error([](auto& w) { w.height += 1; }), HasSubstr("size"));
  EXPECT_THAT(error([](auto& w) { w.pixel_format = 10; }), HasSubstr("pixel_format is 10"));
  EXPECT_THAT(error([](auto& w) { w.camera = "../x"; }), HasSubstr("camera is"));
  EXPECT_THAT(error([](auto& w) { w.exposure_s = -1; }), HasSubstr("exposure_s is -1"));
  EXPECT_THAT(error([](auto& w) { w.radiometry.kind = 3; }), HasSubstr("radiometry.kind is 3"));
  EXPECT_THAT(error([](auto& w) { w.radiometry.planck_b = 0; }), HasSubstr("planck_b"));
  EXPECT_THAT(error([](auto& w) { w.radiometry.emissivity = 0; }), HasSubstr("emissivity"));
  image.format = PixelFormat::kBgr8;
  EXPECT_THAT(ErrorOf([&] { Encode(image); }), HasSubstr("type of pixels is CV_16UC1"));
}

TEST_F(Invalid, Cloud) {
  CloudChunk chunk = random_.Chunk(2, 3);
  chunk.cloud.origins = {{0, 0, 0}, {0, 0, 1}};
  chunk.cloud.points[0] = {1, 2, 3};
  chunk.cloud.points[4] = chunk.cloud.points[5] = Eigen::Vector3f::Constant(kNan);
  const auto error = [&](auto change) { return ErrorAfter<cloud_t>(chunk, change); };
  EXPECT_EQ(error([](auto&) {}), "no error");
  EXPECT_THAT(error([](auto& w) { w.num_lines = 3; }), HasSubstr("num_points is 6; expected 9"));
  EXPECT_THAT(error([](auto& w) { w.num_beams = -3; }), HasSubstr("num_beams is -3"));
  EXPECT_THAT(error([](auto& w) { w.num_lines = 6, w.num_beams = 1; }), HasSubstr("num_origins"));
  EXPECT_THAT(error([](auto& w) { w.organised = 0; }), HasSubstr("num_lines is 2"));
  EXPECT_THAT(error([](auto& w) { w.x_m[0] = NAN; }), HasSubstr("point[0] is (nan"));
  EXPECT_THAT(error([](auto& w) { w.y_m[0] = INFINITY; }), HasSubstr("point[0]"));
  EXPECT_THAT(error([](auto& w) { w.x_m[0] = w.y_m[0] = w.z_m[0] = 0; }), HasSubstr("point[0]"));
  EXPECT_THAT(error([](auto& w) { w.intensity[1] = 1.5; }), HasSubstr("intensity[1] is 1.5"));
  EXPECT_THAT(error([](auto& w) { w.ring[3] = -2; }), HasSubstr("ring[3] is -2"));
  EXPECT_THAT(error([](auto& w) { w.miss_index.back() = 6; }), HasSubstr("miss_index"));
  EXPECT_THAT(error([](auto& w) { w.miss_index.back() = -1; }), HasSubstr("miss_index"));
  EXPECT_THAT(error([](auto& w) { w.miss_index.front() = 0; }), HasSubstr("miss_index"));
  EXPECT_THAT(error([](auto& w) { w.miss_index.front() = w.miss_index.back(); }),
              HasSubstr("ascending"));
  EXPECT_THAT(error([](auto& w) { w.miss_x[0] = 7; }), HasSubstr("length of miss"));
  EXPECT_THAT(error([](auto& w) { w.origin_z_m[1] = NAN; }), HasSubstr("origin[1]"));
  EXPECT_THAT(error([](auto& w) { w.utime = 5, w.utime_offset_us[2] = -5; }),
              HasSubstr("utime_offset_us[2]"));
  chunk.cloud.ring.pop_back();
  EXPECT_THAT(ErrorOf([&] { Encode(chunk); }), HasSubstr("length of ring is 5; expected 6"));
}

TEST_F(Invalid, CalibrationAndPose) {
  CalibrationMessage message = random_.Calibrated();
  message.calibration.covariance = Matrix6d::Identity();
  const auto error = [&](auto change) { return ErrorAfter<calibration_t>(message, change); };
  EXPECT_THAT(error([](auto& w) { w.quaternion_wxyz[0] += 0.1; }), HasSubstr("norm of quaternion"));
  EXPECT_THAT(error([](auto& w) { w.quaternion_wxyz[1] = NAN; }), HasSubstr("quaternion_wxyz[1]"));
  EXPECT_THAT(error([](auto& w) { w.translation_m[2] = INFINITY; }), HasSubstr("translation_m[2]"));
  EXPECT_THAT(error([](auto& w) { w.covariance[1][1] = -1; }), HasSubstr("covariance"));
  EXPECT_THAT(error([](auto& w) { w.status = 7; }), HasSubstr("status is 7"));
  EXPECT_THAT(error([](auto& w) { w.covariance[1][2] = 1; }), HasSubstr("symmetric"));
  EXPECT_THAT(error([](auto& w) { w.has_covariance = 0, w.covariance[1][2] = 1; }), "no error");
  StampedPose pose = random_.Pose();
  pose.map_from_lidar.rotation.coeffs() *= 1.0005;
  EXPECT_EQ(ErrorOf([&] { Encode(pose); }), "no error");
  pose.map_from_lidar.rotation.coeffs().setZero();
  EXPECT_THAT(ErrorOf([&] { Encode(pose); }), HasSubstr("norm of quaternion_wxyz is 0"));
}

TEST_F(Invalid, Timing) {
  CalibrationMessage message = random_.Calibrated();
  message.calibration.timing = CameraTiming{{0.1, 1e-4}, {-0.02, 1e-5}};
  const auto error = [&](auto change) {
    return ErrorAfter<calibration_t>(message, [&](auto& w) { change(w.timing); });
  };
  EXPECT_THAT(error([](auto& w) { w.time_offset_s = NAN; }), HasSubstr("timing.time_offset_s is"));
  EXPECT_THAT(error([](auto& w) { w.time_offset_s = 61; }), HasSubstr("time_offset_s is 61"));
  EXPECT_THAT(error([](auto& w) { w.time_offset_sigma_s = -1; }), HasSubstr("sigma_s is -1"));
  EXPECT_THAT(error([](auto& w) { w.rolling_s = -2; }), HasSubstr("timing.rolling_s is -2"));
  EXPECT_THAT(error([](auto& w) { w.rolling_sigma_s = NAN; }), HasSubstr("rolling_sigma_s"));
}

TEST_F(Invalid, RangeErrors) {
  CalibrationMessage message = random_.Calibrated();
  RangeErrors errors;
  errors.rings = {{0, {0.01, 0.001}}, {5, {-0.01, 0}}, {255, {0, 0.002}}};
  errors.intensities = {{-2, {0.01, 0.001}}, {-1, {0.02, 0.001}}, {0, {0, 0.001}}};
  message.calibration.range_errors = errors;
  const auto error = [&](auto change) {
    return ErrorAfter<calibration_t>(message, [&](auto& w) { change(w.range_errors); });
  };
  EXPECT_EQ(error([](auto&) {}), "no error");
  EXPECT_THAT(error([](auto& w) { w.offset_m = NAN; }), HasSubstr("range_errors.offset_m is nan"));
  EXPECT_THAT(error([](auto& w) { w.offset_sigma_m = -1; }),
              HasSubstr("range_errors.offset_sigma_m is -1"));
  EXPECT_THAT(error([](auto& w) { w.beams_meet_m = INFINITY; }),
              HasSubstr("range_errors.beams_meet_m is inf"));
  EXPECT_THAT(error([](auto& w) { w.beams_meet_sigma_m = NAN; }),
              HasSubstr("range_errors.beams_meet_sigma_m is nan"));
  EXPECT_THAT(error([](auto& w) { w.ring_offset_m[1] = NAN; }),
              HasSubstr("range_errors.ring_offset_m[1] is nan"));
  EXPECT_THAT(error([](auto& w) { w.ring_offset_sigma_m[2] = INFINITY; }),
              HasSubstr("range_errors.ring_offset_sigma_m[2] is inf"));
  EXPECT_THAT(error([](auto& w) { w.intensity_offset_m[0] = -INFINITY; }),
              HasSubstr("range_errors.intensity_offset_m[0] is -inf"));
  EXPECT_THAT(error([](auto& w) { w.intensity_offset_sigma_m[1] = -0.1; }),
              HasSubstr("range_errors.intensity_offset_sigma_m[1] is -0.1"));
  EXPECT_THAT(error([](auto& w) { w.ring[0] = -1; }),
              HasSubstr("range_errors.ring[0] is -1; expected 0 to 255"));
  EXPECT_THAT(error([](auto& w) { w.ring[1] = 0; }),
              HasSubstr("range_errors.ring[1] is 0; expected 1 to 255"));
  EXPECT_THAT(error([](auto& w) { w.ring[2] = 256; }), HasSubstr("range_errors.ring[2] is 256"));
  EXPECT_THAT(error([](auto& w) { w.log2_intensity[0] = NAN; }),
              HasSubstr("range_errors.log2_intensity[0] is nan"));
  EXPECT_THAT(error([](auto& w) {
                w.log2_intensity = {-17, -16, -15};
              }),
              HasSubstr("range_errors.log2_intensity[0] is -17; expected -16 to 0"));
  EXPECT_THAT(error([](auto& w) {
                w.log2_intensity = {-1, 0, 1};
              }),
              HasSubstr("range_errors.log2_intensity[2] is 1"));
  EXPECT_THAT(
      error([](auto& w) { w.log2_intensity[1] = -1.5; }),
      HasSubstr("range_errors.log2_intensity[1] is -1.5; expected -16 to 0, each one more"));
  // What is not there is not read.
  EXPECT_EQ(ErrorAfter<calibration_t>(
                message, [](auto& w) { w.has_range_errors = 0, w.range_errors.offset_m = NAN; }),
            "no error");
  // The sender refuses it, too.
  message.calibration.range_errors->rings[1].ring = 0;
  EXPECT_THAT(ErrorOf([&] { Encode(message); }), HasSubstr("range_errors.ring[1] is 0"));
}

TEST_F(Invalid, Session) {
  const auto command = [&](auto change) {
    return ErrorAfter<session_command_t>(random_.Command(), change);
  };
  EXPECT_THAT(command([](auto& w) { w.verb = 0; }), HasSubstr("verb is 0"));
  EXPECT_THAT(command([](auto& w) { w.verb = 9; }), HasSubstr("verb is 9"));
  EXPECT_THAT(command([](auto& w) { w.view = "a/b"; }), HasSubstr("view is"));
  const auto event = [&](auto change) {
    return ErrorAfter<session_event_t>(random_.Event(), change);
  };
  EXPECT_THAT(event([](auto& w) { w.kind = 4; }), HasSubstr("kind is 4"));
  EXPECT_THAT(event([](auto& w) { w.fraction = NAN; }), HasSubstr("fraction is nan"));
  EXPECT_THAT(event([](auto& w) { w.source = ""; }), HasSubstr("source is"));
  for (const char* control : {"\x1b[2J", "\x7f", "\u009b2J", "\u2028", "\u202e", "\u2066"}) {
    EXPECT_THAT(event([&](auto& w) { w.text = std::string("\u0432") + control; }),
                AllOf(HasSubstr("text is"), HasSubstr("(byte 2)")));
  }
  EXPECT_THAT(event([](auto& w) { w.text.assign(70000, 'x'); }), HasSubstr("length of text"));
  const auto request = [&](auto change) {
    return ErrorAfter<session_request_t>(random_.Request(), change);
  };
  EXPECT_THAT(request([](auto& w) { w.request = 0; }), HasSubstr("request is 0"));
  EXPECT_THAT(request([](auto& w) { w.request = 5; }), HasSubstr("request is 5"));
  const auto left_out = [&](auto change) {
    return ErrorAfter<left_out_views_t>(random_.LeftOut(), change);
  };
  EXPECT_THAT(left_out([](auto& w) {
                w.left_out = {"0001", ""};
                w.num_left_out = 2;
              }),
              HasSubstr("left_out[1] is"));
  const auto target = [&](auto change) {
    return ErrorAfter<target_status_t>(random_.TargetSeen(), change);
  };
  EXPECT_THAT(target([](auto& w) { w.camera = "a b"; }), HasSubstr("camera is"));
  EXPECT_THAT(target([](auto& w) { w.centre_m[1] = NAN; }), HasSubstr("centre_m"));
  const auto waving = [&](auto change) {
    WaveProgress told = random_.Waving();
    told.clocks = {{"rgb", Estimate{0.01, 0.001}, ""}};
    return ErrorAfter<wave_progress_t>(told, change);
  };
  EXPECT_THAT(waving([](auto& w) { w.phase = 0; }), HasSubstr("phase is 0"));
  EXPECT_THAT(waving([](auto& w) { w.phase = 6; }), HasSubstr("phase is 6"));
  EXPECT_THAT(waving([](auto& w) { w.left_s = -1; }), HasSubstr("left_s is -1"));
  EXPECT_THAT(waving([](auto& w) { w.clocks[0].camera = "../rgb"; }), HasSubstr("clocks.camera"));
  EXPECT_THAT(waving([](auto& w) { w.clocks[0].time_offset_s = 61; }),
              HasSubstr("clocks.time_offset_s is 61"));
  EXPECT_THAT(waving([](auto& w) { w.clocks[0].time_offset_s = NAN; }),
              HasSubstr("clocks.time_offset_s is nan"));
  EXPECT_THAT(waving([](auto& w) { w.clocks[0].time_offset_sigma_s = -1; }),
              HasSubstr("clocks.time_offset_sigma_s"));
  const auto watched = [&](auto change) {
    return ErrorAfter<mount_check_t>(random_.Watched(), change);
  };
  EXPECT_THAT(watched([](auto& w) { w.mount_state = 0; }), HasSubstr("mount_state is 0"));
  EXPECT_THAT(watched([](auto& w) { w.mount_state = 5; }), HasSubstr("mount_state is 5"));
  EXPECT_THAT(watched([](auto& w) {
                w.has_holds = 1;
                w.holds = 1.5;
              }),
              HasSubstr("holds is 1.5"));
  EXPECT_THAT(watched([](auto& w) { w.told[2] = -0.5; }), HasSubstr("told is -0.5"));
  EXPECT_THAT(watched([](auto& w) { w.shown = NAN; }), HasSubstr("shown is"));
  EXPECT_THAT(watched([](auto& w) { w.moved[4] = INFINITY; }), HasSubstr("moved[4] is"));
  EXPECT_THAT(watched([](auto& w) { w.covariance[1][1] = -1; }), HasSubstr("covariance"));
  const auto driven = [&](auto change) {
    return ErrorAfter<odometry_t>(random_.Odometry(), change);
  };
  EXPECT_THAT(driven([](auto& w) { w.velocity[5] = NAN; }), HasSubstr("velocity[5] is nan"));
  EXPECT_THAT(driven([](auto& w) { w.covariance[2][2] = -1; }), HasSubstr("covariance"));
  EXPECT_THAT(driven([](auto& w) { w.residual_m = -1; }), HasSubstr("residual_m is -1"));
  SweepOdometry odometry = random_.Odometry();
  odometry.untold = {std::string("a\0b", 3)};
  EXPECT_THAT(ErrorOf([&] { Encode(odometry); }), HasSubstr("untold is"));
  Status status = random_.Health();
  status.text = std::string("a\0b", 3);
  EXPECT_THAT(ErrorOf([&] { Encode(status); }), HasSubstr("text is"));
  status = random_.Health();
  status.counters = {{"received", std::numeric_limits<std::int64_t>::min()}};
  EXPECT_THAT(ErrorOf([&] { Encode(status); }),
              HasSubstr("counter_value[0] is -9223372036854775808"));
}

}  // namespace
}  // namespace rgbdt
