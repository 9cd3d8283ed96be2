#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "calib/model/errors.h"
#include "services/drivers/livox/livox_packets.h"
#include "services/drivers/livox/livox_sweeps.h"
#include "services/drivers/packets/packet_sweeps.h"
#include "tests/unit/files/test_data.h"
#include "tests/unit/matchers.h"
#include "tests/unit/packets/livox_encoder.h"

namespace rgbdt {
namespace {

using livox::Protocol;
using test::LivoxEncoder;
using testing::HasSubstr;
using testing::SizeIs;

constexpr Utime kArrival = 1'700'000'000'000'000;

std::vector<LivoxEncoder> Encoders() {
  std::vector<LivoxEncoder> encoders;
  for (const int type : {1, 2, 3}) encoders.push_back({false, type});
  for (const int type : {2, 3, 4, 5, 7, 8}) encoders.push_back({true, type});
  return encoders;
}

Protocol Of(const LivoxEncoder& encoder) {
  return encoder.sdk1 ? Protocol::kSdk1 : Protocol::kSdk2;
}

livox::Packet Decode(const LivoxEncoder& encoder, const std::vector<std::uint8_t>& bytes) {
  return livox::Decode(Of(encoder), bytes.data(), bytes.size());
}

// By the protocol's page; angles are in hundredths of a degree, so places to 0.5 mm at 4 m.
TEST(LivoxPackets, PointsLieWhereTheProtocolSays) {
  for (const LivoxEncoder& encoder : Encoders()) {
    const livox::Packet packet = Decode(encoder, encoder.Packet(3));
    EXPECT_EQ(packet.beams, encoder.beams());
    EXPECT_EQ(packet.stamp_ns, encoder.first_ns + 3000 * encoder.period_us());
    EXPECT_NEAR(packet.duration_us, encoder.step_us() * (encoder.beams() - 1), 1e-3);
    std::size_t next = 0;
    int noise = 0;
    for (int beam = 0; beam < encoder.beams(); ++beam) {
      int mm[3];
      const int best = encoder.returns() > 1 ? 1 : 0;
      encoder.Place(beam, best, mm);
      const bool nothing = mm[0] == 0 && mm[1] == 0 && mm[2] == 0;
      if (!nothing && beam % 5 == 0) ++noise;
      if (nothing || beam % 5 == 0) continue;
      ASSERT_LT(next, packet.points.size());
      const livox::Point& point = packet.points[next++];
      EXPECT_EQ(point.reflectivity, encoder.Reflectivity(beam, best));
      EXPECT_NEAR(point.time_us, encoder.step_us() * beam, 1e-2);
      const bool by_angles =
          encoder.type == 3 || (encoder.sdk1 && (encoder.type == 5 || encoder.type == 8));
      if (by_angles && best == 1) {  // a metre farther along the first one's direction
        encoder.Place(beam, 0, mm);
        const Eigen::Vector3d first(mm[0], mm[1], mm[2]);
        const Eigen::Vector3d expected = 1e-3 * (first + 1000 * first.normalized());
        EXPECT_THAT(point.place_m.cast<double>(), EigenNear(expected, 2e-3));
      } else {
        const Eigen::Vector3d expected(1e-3 * mm[0], 1e-3 * mm[1], 1e-3 * mm[2]);
        EXPECT_THAT(point.place_m.cast<double>(), EigenNear(expected, by_angles ? 2e-3 : 1e-6));
      }
    }
    EXPECT_EQ(next, packet.points.size());
    EXPECT_EQ(packet.dropped, noise);
  }
}

TEST(LivoxPackets, ClocksAreToldApart) {
  const auto clock = [](LivoxEncoder encoder, int time_type) {
    encoder.time_type = time_type;
    return Decode(encoder, encoder.Packet(0)).clock;
  };
  EXPECT_EQ(clock({false, 1}, 0), livox::Clock::kSinceStart);
  EXPECT_EQ(clock({false, 1}, 1), livox::Clock::kPtp);
  EXPECT_EQ(clock({false, 1}, 2), livox::Clock::kUtc);
  EXPECT_EQ(clock({true, 2}, 4), livox::Clock::kSinceStart);
  // SDK1's UTC: 2023-11-14 22 h, and microseconds of the hour.
  LivoxEncoder gps{true, 2, 3};
  std::vector<std::uint8_t> stamp = {23, 11, 14, 22};
  LivoxEncoder::Add(800'000'000, 4, &stamp);
  std::memcpy(&gps.first_ns, stamp.data(), 8);
  const livox::Packet packet = Decode(gps, gps.Packet(0));
  EXPECT_EQ(packet.clock, livox::Clock::kUtc);
  EXPECT_EQ(packet.stamp_ns, 1'700'000'000'000'000'000);
}

TEST(LivoxPackets, WhatIsNotKnownIsSaid) {
  const auto why = [](const LivoxEncoder& encoder, std::size_t at, std::uint8_t value) {
    auto bytes = encoder.Packet(0);
    bytes[at] = value;
    return test::ErrorOf([&] { Decode(encoder, bytes); });
  };
  EXPECT_THAT(why({false, 1}, 10, 9), HasSubstr("of type 9; expected 1, 2 or 3"));
  std::vector<std::uint8_t> mid40(18 + 1300, 0);
  mid40[0] = 5;
  EXPECT_THAT(test::ErrorOf([&] { livox::Decode(Protocol::kSdk1, mid40.data(), mid40.size()); }),
              HasSubstr("of type 0; expected 2 to 5, 7 or 8 (Avia)"));
  EXPECT_THAT(why({false, 1}, 11, 7), HasSubstr("its stamp is of type 7"));
  EXPECT_THAT(why({false, 1}, 5, 95), HasSubstr("do not hold 95 of them"));
  EXPECT_THAT(why({false, 1}, 0, 3), HasSubstr("no packet of a Livox"));
  EXPECT_THAT(why({false, 1}, 35, 0x7f), HasSubstr("before 2096"));
  // The inertial sensor's are none.
  const std::vector<std::uint8_t> imu(36 + 24, 0);
  EXPECT_FALSE(livox::IsPacket(Protocol::kSdk2, imu.data(), imu.size()));
}

TEST(LivoxPackets, DamagedOnesAreDecodedOrRefused) {
  for (const LivoxEncoder& encoder : Encoders()) {
    const auto whole = encoder.Packet(1);
    int refused = 0;
    for (std::size_t at = 0; at < whole.size(); ++at) {
      auto damaged = whole;
      damaged[at] ^= 0xff;
      try {
        const livox::Packet packet = Decode(encoder, damaged);
        EXPECT_LE(static_cast<int>(packet.points.size()), encoder.beams());
      } catch (const InputError&) {
        ++refused;
      }
    }
    EXPECT_GT(refused, 2);
    EXPECT_LT(refused, 40);
    for (std::size_t size = 0; size < whole.size(); size += 5) {
      EXPECT_THROW(livox::Decode(Of(encoder), whole.data(), size), InputError);
    }
  }
}

struct Received {
  std::unique_ptr<PacketSweeps> sweeps;
  std::vector<Cloud> clouds;
};

// Packets from `first` on, some left out; each arrives a little late.
Received RunThrough(const LivoxEncoder& encoder, int count, int first_lost = 0, int end_lost = 0) {
  Received run;
  run.sweeps = PacketsByThemselves(encoder.Packet(0));
  EXPECT_NE(run.sweeps, nullptr);
  for (int i = 0; i < count; ++i) {
    if (i >= first_lost && i < end_lost) continue;
    const Utime arrival = kArrival + encoder.period_us() * (i + 1) + (i % 7) * 40;
    for (Cloud& cloud : run.sweeps->Add(encoder.Packet(i), arrival)) {
      run.clouds.push_back(std::move(cloud));
    }
  }
  if (auto last = run.sweeps->Finish()) run.clouds.push_back(std::move(*last));
  return run;
}

TEST(LivoxSweeps, AreASecondsPointsWithoutRings) {
  for (const LivoxEncoder& encoder : {LivoxEncoder{false, 1}, LivoxEncoder{true, 2}}) {
    const Received run = RunThrough(encoder, 5 * encoder.PacketsPerSecond() / 2);
    EXPECT_EQ(run.sweeps->name(), encoder.sdk1 ? "Livox Avia" : "Livox Mid-360");
    EXPECT_EQ(run.sweeps->Lost(), "");
    ASSERT_THAT(run.clouds, SizeIs(2));
    const Cloud& cloud = run.clouds[1];
    EXPECT_FALSE(cloud.organised);
    EXPECT_TRUE(cloud.ring.empty());
    EXPECT_EQ(cloud.lines, 1);
    const std::size_t of_packet = Decode(encoder, encoder.Packet(0)).points.size();
    EXPECT_EQ(cloud.size(), of_packet * static_cast<std::size_t>(encoder.PacketsPerSecond()));
    EXPECT_EQ(cloud.utime.size(), cloud.size());
    // On the host's clock, within what the least late packet was late.
    EXPECT_NEAR(static_cast<double>(run.clouds[0].sweep_utime - kArrival), 0, 60);
    EXPECT_NEAR(static_cast<double>(cloud.sweep_utime - run.clouds[0].sweep_utime), 1e6, 60);
    EXPECT_LT(cloud.utime.back() - cloud.sweep_utime, 1'001'000);
    EXPECT_TRUE(std::is_sorted(cloud.utime.begin(), cloud.utime.end()));
  }
}

// The sensor's clock is 50 ppm slow, packets arrive late by chance.
TEST(LivoxSweeps, WithinACloudTimesAreTheSensorsHoweverPacketsArrive) {
  constexpr double kDrift = 50e-6;
  const LivoxEncoder encoder{false, 1};
  std::mt19937 random(7);
  std::exponential_distribution<double> late_us(1 / 400.0);
  LivoxSweeps sweeps;
  std::vector<Cloud> clouds;
  for (int i = 0; i < 10 * encoder.PacketsPerSecond(); ++i) {  // a rate is fitted after 5 s
    const double sent_us = static_cast<double>(encoder.period_us() * (i + 1)) * (1 + kDrift);
    const Utime arrival = kArrival + std::llround(sent_us + late_us(random));
    auto cloud = sweeps.Add(Decode(encoder, encoder.Packet(i)), arrival);
    if (cloud) clouds.push_back(std::move(*cloud));
  }
  ASSERT_GE(clouds.size(), 8U);
  EXPECT_EQ(sweeps.lost_ms(), 0);
  const livox::Packet packet = Decode(encoder, encoder.Packet(0));
  const std::size_t of_packet = packet.points.size();
  for (const Cloud& cloud : clouds) {
    ASSERT_EQ(cloud.size() % of_packet, 0U);
    const std::size_t last = cloud.size() / of_packet - 1;
    const auto passed = static_cast<double>(cloud.utime[last * of_packet] - cloud.utime[0]);
    EXPECT_NEAR(passed, static_cast<double>(last) * 500, 2 + 500e-6 * passed);
    for (std::size_t i = 0; i <= last; ++i) {
      // To the microsecond that times are rounded to.
      ASSERT_NEAR(static_cast<double>(cloud.utime[i * of_packet] - cloud.utime[0]),
                  passed * static_cast<double>(i) / static_cast<double>(last), 1.5);
    }
  }
}

TEST(LivoxSweeps, PtpAndGpsAreTaken) {
  LivoxEncoder encoder{false, 1, 2, (kArrival + 1234) * 1000};
  EXPECT_EQ(RunThrough(encoder, 2005).clouds.at(0).sweep_utime, kArrival + 1234);
  encoder.time_type = 1;
  encoder.first_ns += 37'000'000'000;  // TAI
  EXPECT_EQ(RunThrough(encoder, 2005).clouds.at(0).sweep_utime, kArrival + 1234);
}

TEST(LivoxSweeps, WhatIsLostIsCounted) {
  const LivoxEncoder encoder{false, 1};
  const Received little = RunThrough(encoder, 4005, 100, 150);  // 25 ms
  EXPECT_THAT(little.clouds, SizeIs(2));
  EXPECT_EQ(little.sweeps->Lost(), "25 ms never came");
  const Received much = RunThrough(encoder, 4005, 100, 500);
  EXPECT_THAT(much.clouds, SizeIs(1));
  EXPECT_THAT(much.sweeps->Lost(), HasSubstr("1 seconds left out, as a tenth or more never came"));
}

// Whoever sends it: a clock that stands still ends no second, and would fill the memory.
TEST(LivoxSweeps, AClockThatStandsStillFillsNoCloudWithoutEnd) {
  const LivoxEncoder encoder{false, 1, 2, kArrival * 1000};
  const livox::Packet packet = Decode(encoder, encoder.Packet(0));
  LivoxSweeps sweeps;
  constexpr std::size_t kMost = 1'000'000;  // points of a cloud
  const std::size_t packets = 2 * kMost / packet.points.size() + 100;
  for (std::size_t i = 0; i < packets; ++i) EXPECT_FALSE(sweeps.Add(packet, kArrival));
  EXPECT_EQ(sweeps.left_out(), 2);
  // It goes on: what is left of the second, and the next one.
  std::vector<Cloud> clouds;
  for (int i = 1; i < 2 * encoder.PacketsPerSecond() + 5; ++i) {
    const livox::Packet next = Decode(encoder, encoder.Packet(i));
    if (auto cloud = sweeps.Add(next, kArrival)) clouds.push_back(std::move(*cloud));
  }
  ASSERT_THAT(clouds, SizeIs(2));
  EXPECT_LT(clouds[0].size(), kMost);
  EXPECT_EQ(clouds[1].size(),
            packet.points.size() * static_cast<std::size_t>(encoder.PacketsPerSecond()));
}

}  // namespace
}  // namespace rgbdt
