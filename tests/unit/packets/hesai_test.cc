#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/drivers/hesai/hesai_packets.h"
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

using Model = HesaiEncoder::Model;

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

const hesai::Sensor& SensorFor(const std::vector<std::uint8_t>& bytes) {
  const hesai::Sensor* sensor = hesai::SensorOf(bytes.data(), bytes.size());
  if (sensor == nullptr) throw InputError("no known sensor's packet");
  return *sensor;
}

std::vector<Cloud> Turns(const HesaiEncoder& encoder, Utime arrival = 0) {
  SpinningSweeps sweeps(hesai::ParseAngles(encoder.Angles(), "angles.csv"));
  std::vector<Cloud> done;
  const int step = 100 * encoder.blocks() / (encoder.dual ? 2 : 1);
  for (int azimuth = 0; azimuth <= 36000 + 18000 + step; azimuth += step) {
    const auto bytes = encoder.Packet(azimuth % 36000, azimuth);
    const auto more =
        sweeps.Add(hesai::Decode(SensorFor(bytes), bytes.data(), bytes.size()), arrival);
    done.insert(done.end(), more.begin(), more.end());
  }
  return done;
}

// Of a revolution of 360 beams, the beam at a channel and place.
void ExpectBeam(const HesaiEncoder& encoder, const Cloud& sweep, int channel, int beam) {
  const int aside = channel == 1 ? 3 : 0;
  const int azimuth = 100 * ((beam + 180 - aside + 360) % 360);
  const auto i = static_cast<std::size_t>((encoder.channels() - 1 - channel) * 360 + beam);
  // The brighter of two returns is a metre farther.
  const int range = encoder.Range_mm(azimuth, channel) + (encoder.dual ? 1000 : 0);
  const bool fires = encoder.Fires(azimuth, channel);
  ASSERT_EQ(sweep.IsHit(i), fires && range != 0) << channel << " " << beam;
  ASSERT_EQ(sweep.directions[i].allFinite(), fires) << channel << " " << beam;
  if (!fires) return;
  const double a = (azimuth / 100.0 + aside) * kDegree,
               e = HesaiEncoder::Elevation_deg(channel) * kDegree;
  const Eigen::Vector3d direction(std::cos(e) * std::cos(a), -std::cos(e) * std::sin(a),
                                  std::sin(e));
  ASSERT_THAT(sweep.directions[i].cast<double>(), EigenNear(direction, 1e-6));
  if (range == 0) return;
  ASSERT_THAT(sweep.points[i].cast<double>(), EigenNear(1e-3 * range * direction, 2e-6));
}

void ExpectPoints(const HesaiEncoder& encoder) {
  const std::vector<Cloud> sweeps = Turns(encoder);
  ASSERT_THAT(sweeps, SizeIs(1));
  ASSERT_EQ(sweeps[0].lines, encoder.channels());
  ASSERT_EQ(sweeps[0].beams, 360);
  for (int channel = 0; channel < encoder.channels(); ++channel) {
    for (int beam = 0; beam < 360; ++beam) ExpectBeam(encoder, sweeps[0], channel, beam);
  }
}

TEST(HesaiSweeps, PointsLieWhereTheManualsSay) {
  for (const Model model : HesaiEncoder::kAll) {
    for (const bool dual : {false, true}) {
      SCOPED_TRACE(testing::Message() << static_cast<int>(model) << (dual ? " dual" : ""));
      ExpectPoints({model, dual});
    }
  }
  ExpectPoints({Model::kOt128, false, true, true});
  ExpectPoints({Model::kOt128, true, true, true});
}

// From the packet's stamp [us]; NaN: it does not fire.
double FiredAfter(const HesaiEncoder& encoder, int first_azimuth, std::size_t column,
                  std::size_t channel) {
  const auto bytes = encoder.Packet(first_azimuth, 0);
  const hesai::Packet packet = hesai::Decode(SensorFor(bytes), bytes.data(), bytes.size());
  return packet.columns.at(column).time_us +
         packet.columns[column].returns.at(channel - 1).after_us;
}

TEST(HesaiPackets, BeamsFireWhenTheManualsSay) {
  constexpr double kNear = 1e-3;
  const HesaiEncoder old{Model::k64};
  EXPECT_NEAR(FiredAfter(old, 0, 5, 1), -42.58 - 23.18, kNear);
  EXPECT_NEAR(FiredAfter(old, 0, 0, 64), -42.58 - 5 * 55.56 - 12.748, kNear);
  EXPECT_NEAR(FiredAfter({Model::k64, true}, 0, 0, 64), -42.58 - 2 * 55.56 - 12.748, kNear);
  EXPECT_NEAR(FiredAfter({Model::kQt64}, 0, 3, 56), 25.71 + 500 + 119.6, kNear);
  EXPECT_NEAR(FiredAfter({Model::kQt64, true}, 0, 1, 1), 25.71 + 166.667 + 2.31, kNear);
  EXPECT_NEAR(FiredAfter({Model::kXt32M}, 0, 0, 17), 5.632 - 5 * 50 + 0.368, kNear);
  EXPECT_NEAR(FiredAfter({Model::kXt32M}, 0, 5, 16), 5.632 + 0.368 + 15 * 2.888, kNear);

  const HesaiEncoder qt{Model::kQt128};
  EXPECT_TRUE(std::isnan(FiredAfter(qt, 0, 0, 1)));
  EXPECT_NEAR(FiredAfter(qt, 0, 0, 35), 9 + 2.312, kNear);
  EXPECT_NEAR(FiredAfter(qt, 0, 0, 99), 9 + 0.6, kNear);
  EXPECT_NEAR(FiredAfter(qt, 0, 1, 99), 9 + 111.11 + 1.456, kNear);
  EXPECT_NEAR(FiredAfter(qt, 0, 1, 1), 9 + 111.11 + 2.312, kNear);
  EXPECT_TRUE(std::isnan(FiredAfter(qt, 0, 1, 35)));
}

TEST(HesaiPackets, BeamsOf128ChannelsFireByStateResolutionAndRange) {
  constexpr double kNear = 1e-3;
  const HesaiEncoder far{Model::k128E3X}, fine{Model::k128E3X, false, true, true};
  HesaiEncoder near = far;
  near.near = 100;
  EXPECT_NEAR(FiredAfter(far, 0, 1, 2), 3.148 + 28.554, kNear);  // state 1
  EXPECT_NEAR(FiredAfter(far, 0, 0, 1), 3.148 - 55.556 + 4.436, kNear);
  EXPECT_NEAR(FiredAfter(near, 0, 0, 1), 3.148 - 55.556 + 5.201, kNear);
  EXPECT_NEAR(FiredAfter(near, 0, 1, 1), 3.148 + 4.436, kNear);
  EXPECT_NEAR(FiredAfter(far, 0, 0, 26), 3.148 - 55.556 + 38.509, kNear);
  EXPECT_NEAR(FiredAfter(far, 0, 1, 26), 3.148 + 37.809, kNear);
  EXPECT_NEAR(FiredAfter(fine, 0, 0, 26), 3.148 - 27.778 + 10.381, kNear);
  EXPECT_NEAR(FiredAfter(fine, 200, 1, 26), 3.148 + 10.031, kNear);  // state 3
  EXPECT_TRUE(std::isnan(FiredAfter(fine, 0, 0, 2)));
  EXPECT_NEAR(FiredAfter(fine, 0, 1, 2), 3.148 + 0.776, kNear);

  const HesaiEncoder ot{Model::kOt128}, fine_ot{Model::kOt128, false, true, true};
  EXPECT_NEAR(FiredAfter(ot, 0, 0, 1), -55.556 + 46.645, kNear);
  EXPECT_NEAR(FiredAfter(ot, 0, 1, 3), 21.011, kNear);
  EXPECT_NEAR(FiredAfter(fine_ot, 200, 0, 25), -27.778 + 22.664, kNear);
  EXPECT_NEAR(FiredAfter({Model::kOt128, true}, 100, 0, 64), 24.982, kNear);
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

// Packets of one column: 360 a turn, the seams are between packets 179 and 180, 539 and 540, ...
TEST(HesaiSweeps, WhatNeverCameIsCountedOfPacketsOfOneColumn) {
  const HesaiEncoder encoder{Model::kOt128, true};
  const auto drive = [&](int first_lost, int end_lost) {
    auto sweeps = HesaiPackets(hesai::ParseAngles(encoder.Angles(), "angles.csv"));
    std::size_t done = 0;
    for (int i = 0; i < 3 * 360 + 200; ++i) {
      if (i >= first_lost && i < end_lost) continue;
      const int us = 56 * i;
      done += sweeps->Add(encoder.Packet(100 * i % 36000, us), kHesaiSecond + us).size();
    }
    return std::to_string(done) + " " + sweeps->Lost();
  };
  EXPECT_EQ(drive(0, 0), "3 ");
  EXPECT_EQ(drive(600, 605), "3 5 columns never came");
  EXPECT_EQ(drive(600, 800), "2 1 revolutions left out, as half a turn or more never came");
  EXPECT_EQ(drive(600, 960), "1 1 revolutions left out, as half a turn or more never came");
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
  for (const Model model : HesaiEncoder::kAll) {
    const HesaiEncoder encoder{model};
    const auto whole = encoder.Packet(100, 5);
    const hesai::Sensor& sensor = SensorFor(whole);
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
    EXPECT_LE(refused, 2 * encoder.blocks() + 9);
    EXPECT_THROW(hesai::Decode(sensor, whole.data(), sensor.head_bytes + 100), InputError);
    EXPECT_EQ(hesai::SensorOf(whole.data(), 0), nullptr);
    auto longer = whole;
    longer.resize(whole.size() + 100);
    EXPECT_EQ(hesai::SensorOf(longer.data(), longer.size()), nullptr);
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
  EXPECT_THAT(test::ErrorOf([] { PacketsByMetadata(HesaiEncoder::Angles(7), "angles.csv"); }),
              HasSubstr("7 channels"));
}

TEST(HesaiAngles, ASumBehindThemIsPassedOver) {
  const std::string sum(64, '7');
  EXPECT_THAT(hesai::ParseAngles("EEFF,1,1\nLaser id,Elevation,Azimuth\n1,2,3\n" + sum, "a.csv")
                  .azimuth_rad,
              SizeIs(1));
}

TEST(HesaiPackets, APacketTellsWhichOfSeveralSensorsItIsOf) {
  for (const Model model : {Model::k128E3X, Model::kOt128, Model::kQt128}) {
    const HesaiEncoder encoder{model};
    const auto packets = HesaiPackets(hesai::ParseAngles(encoder.Angles(), "angles.csv"));
    EXPECT_EQ(packets->name(), "Hesai of 128 channels");
    const auto bytes = encoder.Packet(0, 0);
    ASSERT_TRUE(packets->IsOurs(bytes));
    packets->Add(bytes, kHesaiSecond);
    EXPECT_EQ(packets->name(), SensorFor(bytes).name);
    EXPECT_FALSE(packets->IsOurs(HesaiEncoder{Model::k40P}.Packet(0, 0)));
    const Model other = model == Model::kQt128 ? Model::kOt128 : Model::kQt128;
    EXPECT_FALSE(packets->IsOurs(HesaiEncoder{other}.Packet(0, 0)));
  }
}

}  // namespace
}  // namespace rgbdt
