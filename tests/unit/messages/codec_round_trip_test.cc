#include <gtest/gtest.h>

#include <cstring>

#include "services/messages/codec.h"
#include "tests/unit/messages/codec_testing.h"
#include "tests/unit/messages/random_messages.h"

namespace rgbdt {
namespace {

using testing::ExpectSameRigid;
using testing::RandomMessages;
using testing::ThroughTheWire;

bool Same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

template <typename A>
bool SameNumbers(const std::vector<A>& a, const std::vector<A>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const auto& x, const auto& y) { return Same(x, y); });
}

template <typename Row>
bool SameRows(const std::vector<Row>& a, const std::vector<Row>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Row& x, const Row& y) {
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      if (!Same(x[i], y[i])) return false;
    }
    return true;
  });
}

constexpr int kRounds = 100;

class RoundTrip : public ::testing::Test {
 protected:
  RandomMessages random_{1};
};

// What has crossed once crosses again unchanged, to the bit: live and replay agree.
TEST_F(RoundTrip, EncodingTheDecodedGivesTheSameBytes) {
  for (int round = 0; round < kRounds; ++round) {
    for (const Message& message : random_.OneOfEach()) {
      const std::string channel = ChannelOf(message);
      const Bytes bytes = Encode(message);
      const Message decoded = Decode(channel, bytes.data(), bytes.size());
      EXPECT_EQ(decoded.index(), message.index());
      EXPECT_EQ(SeqOf(decoded), SeqOf(message));
      EXPECT_EQ(UtimeOf(decoded), UtimeOf(message));
      EXPECT_EQ(Encode(decoded), bytes) << channel;
    }
  }
}

TEST_F(RoundTrip, LineScan) {
  for (int round = 0; round < kRounds; ++round) {
    const LineScan a = random_.Line();
    const LineScan b = ThroughTheWire(a);
    EXPECT_EQ(a.beam_period_s, b.beam_period_s);
    EXPECT_EQ(a.first_angle_rad, b.first_angle_rad);
    EXPECT_EQ(a.angle_step_rad, b.angle_step_rad);
    EXPECT_TRUE(SameNumbers(a.range, b.range));
    EXPECT_TRUE(SameNumbers(a.intensity, b.intensity));
  }
}

TEST_F(RoundTrip, Encoder) {
  for (int round = 0; round < kRounds; ++round) {
    const EncoderReading a = random_.Encoder();
    const EncoderReading b = ThroughTheWire(a);
    EXPECT_EQ(a.ticks, b.ticks);
    EXPECT_EQ(a.sweep_utime, b.sweep_utime);
  }
}

TEST_F(RoundTrip, Image) {
  for (int round = 0; round < kRounds; ++round) {
    const Image a = random_.Picture();
    const Image b = ThroughTheWire(a);
    EXPECT_EQ(a.camera, b.camera);
    EXPECT_EQ(a.frame_number, b.frame_number);
    EXPECT_EQ(a.device_utime, b.device_utime);
    EXPECT_EQ(a.exposure_s, b.exposure_s);
    EXPECT_EQ(a.format, b.format);
    EXPECT_EQ(a.shutter_correcting, b.shutter_correcting);
    ASSERT_EQ(a.pixels.type(), b.pixels.type());
    ASSERT_EQ(a.pixels.size(), b.pixels.size());
    EXPECT_EQ(0, std::memcmp(a.pixels.data, b.pixels.data, a.pixels.total() * a.pixels.elemSize()));
    EXPECT_EQ(a.radiometry.kind, b.radiometry.kind);
    EXPECT_EQ(a.radiometry.gain, b.radiometry.gain);
    EXPECT_EQ(a.radiometry.offset, b.radiometry.offset);
    EXPECT_EQ(a.radiometry.r, b.radiometry.r);
    EXPECT_EQ(a.radiometry.b, b.radiometry.b);
    EXPECT_EQ(a.radiometry.f, b.radiometry.f);
    EXPECT_EQ(a.radiometry.o, b.radiometry.o);
    EXPECT_EQ(a.radiometry.emissivity, b.radiometry.emissivity);
    EXPECT_EQ(a.radiometry.reflected_temperature_k, b.radiometry.reflected_temperature_k);
  }
}

TEST_F(RoundTrip, Cloud) {
  for (int round = 0; round < kRounds; ++round) {
    const CloudChunk chunk = random_.Chunk();
    const CloudChunk back = ThroughTheWire(chunk);
    EXPECT_EQ(chunk.sweep_end, back.sweep_end);
    EXPECT_EQ(chunk.sweep_lines, back.sweep_lines);
    EXPECT_EQ(chunk.lines_lost, back.lines_lost);
    const Cloud& a = chunk.cloud;
    const Cloud& b = back.cloud;
    EXPECT_EQ(a.sweep_utime, b.sweep_utime);
    EXPECT_EQ(a.first_line, b.first_line);
    EXPECT_EQ(a.lines, b.lines);
    EXPECT_EQ(a.beams, b.beams);
    EXPECT_EQ(a.organised, b.organised);
    EXPECT_TRUE(SameRows(a.points, b.points));
    EXPECT_TRUE(SameRows(a.origins, b.origins));
    EXPECT_TRUE(SameNumbers(a.intensity, b.intensity));
    EXPECT_EQ(a.utime, b.utime);
    EXPECT_EQ(a.ring, b.ring);
    ASSERT_EQ(a.directions.size(), b.directions.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
      // A miss' direction travels, a hit's follows from its point.
      if (a.IsHit(i)) {
        EXPECT_TRUE(std::isnan(b.directions[i].x()));
        EXPECT_LT((a.directions[i] - DirectionOf(b, i)).norm(), 1e-5);
      } else {
        EXPECT_EQ(a.directions[i], DirectionOf(b, i));
      }
    }
  }
}

TEST_F(RoundTrip, CornerSelection) {
  for (int round = 0; round < kRounds; ++round) {
    const CornerSelection a = random_.Corners();
    const CornerSelection b = ThroughTheWire(a);
    EXPECT_EQ(a.camera, b.camera);
    EXPECT_EQ(a.image_utime, b.image_utime);
    EXPECT_EQ(a.corners, b.corners);
  }
}

TEST_F(RoundTrip, Calibration) {
  for (int round = 0; round < kRounds; ++round) {
    const CalibrationMessage a = random_.Calibrated();
    const CalibrationMessage b = ThroughTheWire(a);
    EXPECT_EQ(a.rig_hash, b.rig_hash);
    EXPECT_EQ(a.method, b.method);
    EXPECT_EQ(a.calibration.camera, b.calibration.camera);
    EXPECT_EQ(a.calibration.status, b.calibration.status);
    EXPECT_EQ(a.calibration.detail, b.calibration.detail);
    ExpectSameRigid(a.calibration.camera_from_lidar, b.calibration.camera_from_lidar);
    EXPECT_EQ(a.calibration.covariance, b.calibration.covariance);
    ASSERT_EQ(a.calibration.lens.has_value(), b.calibration.lens.has_value());
    if (a.calibration.lens) {
      EXPECT_EQ(a.calibration.lens->lens, b.calibration.lens->lens);
      EXPECT_EQ(a.calibration.lens->covariance, b.calibration.lens->covariance);
    }
    EXPECT_TRUE(a.calibration.range_errors == b.calibration.range_errors);
    EXPECT_TRUE(a.calibration.timing == b.calibration.timing);
  }
}

TEST_F(RoundTrip, Pose) {
  for (int round = 0; round < kRounds; ++round) {
    const StampedPose a = random_.Pose();
    const StampedPose b = ThroughTheWire(a);
    EXPECT_EQ(a.source, b.source);
    ExpectSameRigid(a.map_from_lidar, b.map_from_lidar);
  }
}

TEST_F(RoundTrip, RigAndReport) {
  for (int round = 0; round < kRounds; ++round) {
    const RigText a = random_.RigFile();
    const RigText b = ThroughTheWire(a);
    EXPECT_EQ(a.hash, b.hash);
    EXPECT_EQ(a.text, b.text);
    const ReportText report = random_.Report();
    EXPECT_EQ(report.json, ThroughTheWire(report).json);
  }
}

TEST_F(RoundTrip, Session) {
  for (int round = 0; round < kRounds; ++round) {
    const SessionCommand a = random_.Command();
    const SessionCommand b = ThroughTheWire(a);
    EXPECT_EQ(a.command, b.command);
    EXPECT_EQ(a.verb, b.verb);
    EXPECT_EQ(a.view, b.view);
    EXPECT_EQ(a.sweep_utime, b.sweep_utime);
    EXPECT_EQ(a.heldout, b.heldout);
    EXPECT_EQ(a.picked_cameras, b.picked_cameras);
    const SessionEvent event = random_.Event();
    const SessionEvent back = ThroughTheWire(event);
    EXPECT_EQ(event.command, back.command);
    EXPECT_EQ(event.source, back.source);
    EXPECT_EQ(event.kind, back.kind);
    EXPECT_EQ(event.text, back.text);
    EXPECT_EQ(event.sweep_utime, back.sweep_utime);
    EXPECT_EQ(event.fraction, back.fraction);
  }
}

TEST_F(RoundTrip, RequestAndTargetStatus) {
  for (int round = 0; round < kRounds; ++round) {
    const SessionRequest a = random_.Request();
    const SessionRequest b = ThroughTheWire(a);
    EXPECT_EQ(a.utime, b.utime);
    EXPECT_EQ(a.request, b.request);
    EXPECT_EQ(a.heldout, b.heldout);
    const LeftOutViews left_out = random_.LeftOut();
    EXPECT_EQ(left_out.utime, ThroughTheWire(left_out).utime);
    EXPECT_EQ(left_out.views, ThroughTheWire(left_out).views);
    const TargetStatus status = random_.TargetSeen();
    const TargetStatus back = ThroughTheWire(status);
    EXPECT_EQ(status.utime, back.utime);
    EXPECT_EQ(status.camera, back.camera);
    EXPECT_EQ(status.seen, back.seen);
    EXPECT_EQ(status.text, back.text);
    EXPECT_EQ(status.corners, back.corners);
    EXPECT_EQ(status.outline, back.outline);
    EXPECT_EQ(status.centre, back.centre);
  }
}

TEST_F(RoundTrip, WaveProgress) {
  for (int round = 0; round < kRounds; ++round) {
    const WaveProgress a = random_.Waving();
    const WaveProgress b = ThroughTheWire(a);
    EXPECT_EQ(a.utime, b.utime);
    EXPECT_EQ(a.phase, b.phase);
    EXPECT_EQ(a.left_s, b.left_s);
    EXPECT_EQ(a.text, b.text);
    ASSERT_EQ(a.clocks.size(), b.clocks.size());
    for (std::size_t i = 0; i < a.clocks.size(); ++i) {
      EXPECT_EQ(a.clocks[i].camera, b.clocks[i].camera);
      EXPECT_EQ(a.clocks[i].text, b.clocks[i].text);
      ASSERT_EQ(a.clocks[i].time_offset_s.has_value(), b.clocks[i].time_offset_s.has_value());
      if (!a.clocks[i].time_offset_s) continue;
      EXPECT_EQ(a.clocks[i].time_offset_s->value, b.clocks[i].time_offset_s->value);
      EXPECT_EQ(a.clocks[i].time_offset_s->sigma, b.clocks[i].time_offset_s->sigma);
    }
  }
}

TEST_F(RoundTrip, MountCheck) {
  for (int round = 0; round < kRounds; ++round) {
    const MountCheck a = random_.Watched();
    const MountCheck b = ThroughTheWire(a);
    EXPECT_EQ(a.utime, b.utime);
    EXPECT_EQ(a.camera, b.camera);
    EXPECT_EQ(a.calibration_utime, b.calibration_utime);
    EXPECT_EQ(a.sweeps, b.sweeps);
    EXPECT_EQ(a.state, b.state);
    EXPECT_EQ(a.holds, b.holds);
    EXPECT_EQ(a.camera_from_lidar.translation, b.camera_from_lidar.translation);
    EXPECT_EQ(a.moved, b.moved);
    EXPECT_EQ(a.covariance, b.covariance);
    EXPECT_EQ(a.told, b.told);
    EXPECT_EQ(a.edges, b.edges);
    EXPECT_EQ(a.shown, b.shown);
    EXPECT_EQ(a.where, b.where);
    EXPECT_EQ(a.text, b.text);
  }
}

TEST_F(RoundTrip, Odometry) {
  for (int round = 0; round < kRounds; ++round) {
    const SweepOdometry a = random_.Odometry();
    const SweepOdometry b = ThroughTheWire(a);
    EXPECT_EQ(a.utime, b.utime);
    EXPECT_EQ(a.placed, b.placed);
    EXPECT_EQ(a.begun_anew, b.begun_anew);
    EXPECT_EQ(a.map_from_lidar.translation, b.map_from_lidar.translation);
    EXPECT_EQ(a.velocity, b.velocity);
    EXPECT_EQ(a.covariance, b.covariance);
    EXPECT_EQ(a.untold, b.untold);
    EXPECT_EQ(a.residual_m, b.residual_m);
    EXPECT_EQ(a.text, b.text);
  }
}

TEST_F(RoundTrip, Status) {
  for (int round = 0; round < kRounds; ++round) {
    const Status a = random_.Health();
    const Status b = ThroughTheWire(a);
    EXPECT_EQ(a.process, b.process);
    EXPECT_EQ(a.ready, b.ready);
    EXPECT_EQ(a.text, b.text);
    EXPECT_EQ(a.last_problem, b.last_problem);
    EXPECT_EQ(a.counters, b.counters);
  }
}

// A sensor that gives only points: what it does not give comes back as "unknown", at full length,
// so that chunks with and without it can be joined.
TEST(CloudOnTheWire, WhatIsUnknownComesBackAtFullLength) {
  CloudChunk chunk;
  chunk.cloud.sweep_utime = 1000;
  chunk.cloud.lines = 1;
  chunk.cloud.beams = 2;
  chunk.cloud.points = {{2, 0, 0}, Eigen::Vector3f::Constant(testing::kNan)};
  const Cloud cloud = ThroughTheWire(chunk).cloud;
  ASSERT_EQ(cloud.directions.size(), 2U);
  EXPECT_EQ(DirectionOf(cloud, 0), Eigen::Vector3f(1, 0, 0));
  EXPECT_TRUE(std::isnan(DirectionOf(cloud, 1).x()));
  EXPECT_TRUE(cloud.origins.empty());
  EXPECT_TRUE(SameNumbers(cloud.intensity, {testing::kNan, testing::kNan}));
  EXPECT_EQ(cloud.ring, (std::vector<std::uint16_t>{65535, 65535}));
  EXPECT_EQ(cloud.utime, (std::vector<Utime>{1000, 1000}));
}

TEST(CloudOnTheWire, EmptySweepEnd) {
  CloudChunk chunk;
  chunk.cloud.sweep_utime = 1000;
  chunk.sweep_end = true;
  chunk.sweep_lines = 300;
  const CloudChunk back = ThroughTheWire(chunk);
  EXPECT_TRUE(back.sweep_end);
  EXPECT_EQ(back.sweep_lines, 300);
  EXPECT_TRUE(back.cloud.points.empty());
}

// A region of a larger picture: rows are not contiguous.
TEST(ImageOnTheWire, RowsOfARegion) {
  cv::Mat whole(10, 10, CV_16UC1);
  for (int i = 0; i < 100; ++i)
    whole.at<std::uint16_t>(i / 10, i % 10) = static_cast<std::uint16_t>(700 * i);
  Image image;
  image.camera = "thermal";
  image.utime = 1;
  image.format = PixelFormat::kMono16;
  image.pixels = whole(cv::Rect(3, 2, 4, 5));
  const Image back = ThroughTheWire(image);
  ASSERT_EQ(back.pixels.size(), cv::Size(4, 5));
  EXPECT_EQ(back.pixels.at<std::uint16_t>(4, 3), 700 * 66);
}

}  // namespace
}  // namespace rgbdt
