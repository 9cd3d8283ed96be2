#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/drivers/hesai/hesai_sweeps.h"
#include "services/drivers/packets/packet_sweeps.h"
#include "tests/numbers.h"
#include "tests/unit/files/test_data.h"
#include "tests/unit/matchers.h"
#include "tests/unit/packets/hesai_encoder.h"

namespace rgbdt {
namespace {

using test::HesaiEncoder;
using testing::HasSubstr;
using testing::SizeIs;

constexpr Utime kHesaiSecond = HesaiEncoder::kSecond;

// Three turns and a half from the front on, of which some packets are lost.
struct Driven {
  explicit Driven(const HesaiEncoder& encoder, int first_lost = 0, int end_lost = 0) {
    sweeps = HesaiPackets(hesai::ParseAngles(encoder.Angles(), "angles.csv"));
    const int blocks = encoder.blocks();
    for (int i = 0; i * blocks < 360 * 7 / 2 + blocks; ++i) {
      if (i >= first_lost && i < end_lost) continue;
      const int us = 50 * blocks * i;
      for (Cloud& cloud :
           sweeps->Add(encoder.Packet(100 * blocks * i % 36000, us), kHesaiSecond + us)) {
        done.push_back(std::move(cloud));
      }
    }
  }
  std::unique_ptr<PacketSweeps> sweeps;
  std::vector<Cloud> done;
};

std::vector<Cloud> Turns(const HesaiEncoder& encoder, Utime arrival = 0) {
  HesaiSweeps sweeps(hesai::ParseAngles(encoder.Angles(), "angles.csv"));
  std::vector<Cloud> done;
  const int step = 100 * encoder.blocks() / (encoder.dual ? 2 : 1);
  for (int azimuth = 0; azimuth <= 36000 + 18000 + step; azimuth += step) {
    const auto bytes = encoder.Packet(azimuth % 36000, azimuth);
    const auto more =
        sweeps.Add(hesai::Decode(sweeps.sensor(), bytes.data(), bytes.size()), arrival);
    done.insert(done.end(), more.begin(), more.end());
  }
  return done;
}

TEST(HesaiSweeps, PointsLieWhereTheManualsSay) {
  for (HesaiEncoder encoder :
       {HesaiEncoder{false, 16}, HesaiEncoder{false, 32}, HesaiEncoder{true, 40}}) {
    for (const bool dual : {false, true}) {
      encoder.dual = dual;
      const std::vector<Cloud> sweeps = Turns(encoder);
      ASSERT_THAT(sweeps, SizeIs(1));
      const Cloud& sweep = sweeps[0];
      ASSERT_EQ(sweep.lines, encoder.channels);
      ASSERT_EQ(sweep.beams, 360);
      for (int channel = 0; channel < encoder.channels; ++channel) {
        for (int beam = 0; beam < 360; ++beam) {
          const int aside = channel == 1 ? 3 : 0;
          const int azimuth = 100 * ((beam + 180 - aside + 360) % 360);
          const auto i = static_cast<std::size_t>((encoder.channels - 1 - channel) * 360 + beam);
          // The brighter of two returns is a metre farther.
          const int range = encoder.Range_mm(azimuth, channel) + (dual ? 1000 : 0);
          EXPECT_EQ(sweep.IsHit(i), range != 0);
          const double a = (azimuth / 100.0 + aside) * kDegree, e = (15 - channel) * kDegree;
          const Eigen::Vector3d direction(std::cos(e) * std::cos(a), -std::cos(e) * std::sin(a),
                                          std::sin(e));
          EXPECT_THAT(sweep.directions[i].cast<double>(), EigenNear(direction, 1e-6));
          if (range == 0) continue;
          EXPECT_THAT(sweep.points[i].cast<double>(), EigenNear(1e-3 * range * direction, 2e-6));
        }
      }
    }
  }
}

TEST(HesaiSweeps, TimesAreTheSensorsUnlessItsClockWasNeverSet) {
  HesaiEncoder encoder;
  // The first block after the back is the fifth of the packet that begins at 176 degrees.
  const Cloud sweep = Turns(encoder).at(0);
  EXPECT_NEAR(static_cast<double>(sweep.sweep_utime), kHesaiSecond + 17600 + 5.632 - 3 * 50, 1);
  const std::size_t top = 15 * 360;  // channel 0
  EXPECT_NEAR(static_cast<double>(sweep.utime[top]), sweep.sweep_utime + 0.368, 1);
  EXPECT_NEAR(static_cast<double>(sweep.utime[0]), sweep.sweep_utime + 0.368 + 15 * 3.024, 1);
  encoder.has_date = false;
  EXPECT_NEAR(static_cast<double>(Turns(encoder, 77'000'000).at(0).sweep_utime), 77'000'000, 200);
}

// Packets have 8 columns of a degree: a turn has 45, the seams are in packets 22, 67, 112 and 157.
TEST(HesaiSweeps, WhatNeverCameIsCounted) {
  for (const bool has_date : {true, false}) {
    HesaiEncoder encoder;
    encoder.has_date = has_date;
    const Driven all(encoder);
    EXPECT_THAT(all.done, SizeIs(3));
    EXPECT_EQ(all.sweeps->Lost(), "");

    const Driven some(encoder, 80, 82);
    ASSERT_THAT(some.done, SizeIs(3));
    EXPECT_EQ(some.done[1].beams, 360 - 16);
    EXPECT_EQ(some.sweeps->Lost(), "16 columns never came");

    const Driven seam(encoder, 67, 68);
    ASSERT_THAT(seam.done, SizeIs(3));
    EXPECT_EQ(seam.sweeps->Lost(), "8 columns never came");
  }
}

TEST(HesaiSweeps, ARevolutionOfTwoIsLeftOut) {
  for (const bool has_date : {true, false}) {
    for (const int lost : {25, 40, 45, 50}) {  // a turn: the azimuths go on as if nothing was
      HesaiEncoder encoder;
      encoder.has_date = has_date;
      const Driven driven(encoder, 80, 80 + lost);
      ASSERT_FALSE(driven.done.empty());
      for (const Cloud& cloud : driven.done) EXPECT_EQ(cloud.beams, 360) << lost;
      EXPECT_EQ(driven.sweeps->Lost(), "1 revolutions left out, as half a turn or more never came");
    }
  }
}

TEST(HesaiPackets, DamagedOnesAreDecodedOrRefused) {
  for (const HesaiEncoder& encoder : {HesaiEncoder{false, 16}, HesaiEncoder{true, 40}}) {
    const hesai::Sensor& sensor = hesai::SensorOf(static_cast<std::size_t>(encoder.channels));
    const auto whole = encoder.Packet(100, 5);
    ASSERT_TRUE(hesai::IsPacket(sensor, whole.data(), whole.size()));
    int refused = 0;
    for (std::size_t at = 0; at < whole.size(); ++at) {
      auto damaged = whole;
      damaged[at] ^= 0xff;
      try {
        hesai::Decode(sensor, damaged.data(), damaged.size());
      } catch (const InputError&) {
        ++refused;
      }
    }
    EXPECT_GE(refused, encoder.blocks());  // an azimuth's high byte each, the magic, the mode
    EXPECT_LE(refused, 2 * encoder.blocks() + 5);
    EXPECT_THROW(hesai::Decode(sensor, whole.data(), whole.size() - 1), InputError);
    EXPECT_FALSE(hesai::IsPacket(sensor, whole.data(), 0));
  }
}

TEST(HesaiAngles, WhatIsWrongIsSaid) {
  const auto why = [](const std::string& csv) {
    return test::ErrorOf([&] { hesai::ParseAngles(csv, "angles.csv"); });
  };
  EXPECT_THAT(why("Channel,Elevation,Azimuth\n1,2\n"), HasSubstr("angles.csv:2"));
  EXPECT_THAT(why("1,2,3\n1,2,3\n"), HasSubstr("angles.csv:2"));
  EXPECT_THAT(why("1,2,3\n3,2,3\n"), HasSubstr("no channel 2"));
  EXPECT_THAT(why("1,200,3\n"), HasSubstr("angles.csv:1"));
  EXPECT_THAT(why("4000000000,2,3\n"), HasSubstr("angles.csv:1"));
  EXPECT_THAT(why(""), HasSubstr("no channels"));
  EXPECT_THAT(test::ErrorOf([] { hesai::SensorOf(7); }), HasSubstr("7 channels"));
}

}  // namespace
}  // namespace rgbdt
