#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <random>

#include "calib/model/errors.h"
#include "services/drivers/velodyne/velodyne_sweeps.h"
#include "tests/hardware/velodyne_encoder.h"
#include "tests/numbers.h"

namespace rgbdt {
namespace {

using ::testing::HasSubstr;
using Model = VelodyneDevice::Model;

VelodyneEncoder Encoder(Model model) {
  return MadeUpVelodyne(static_cast<VelodyneEncoder::Model>(static_cast<int>(model) - 1));
}

struct Turned {
  std::vector<Cloud> clouds;
  VelodyneSweeps sweeps;
};

// Revolutions of a made-up sensor whose packets leave when their last laser has fired.
Turned Revolve(
    Model model, const VelodyneEncoder& encoder, int packets,
    const std::function<bool(int)>& lost = [](int) { return false; }) {
  Turned run{{}, VelodyneSweeps(model)};
  for (int i = 0; i < packets; ++i) {
    if (lost(i)) continue;
    const auto bytes = encoder.Packet(i);
    const auto packet = velodyne::Decode(velodyne::SensorOf(model), bytes.data(), bytes.size());
    const auto arrival = kJune2015 + std::llround((i + 1) * encoder.PacketDuration_us());
    for (Cloud& cloud : run.sweeps.Add(packet, arrival)) run.clouds.push_back(std::move(cloud));
  }
  return run;
}

int RingOf(const VelodyneEncoder& encoder, int laser) {
  int ring = 0;
  for (int other = 0; other < encoder.lasers(); ++other) {
    ring += encoder.Elevation(other) < encoder.Elevation(laser) ? 1 : 0;
  }
  return ring;
}

class Velodyne : public ::testing::TestWithParam<Model> {};

TEST_P(Velodyne, PointsLieWhereTheSceneIs) {
  const Model model = GetParam();
  const VelodyneEncoder encoder = Encoder(model);
  const Turned run = Revolve(model, encoder, 3 * encoder.PacketsPerTurn() + 2);
  ASSERT_EQ(run.clouds.size(), 2u);
  EXPECT_EQ(run.sweeps.lost_packets(), 0);
  const Cloud& cloud = run.clouds[0];
  const int columns = 36000 / encoder.block_turn * (model == Model::kVlp16 ? 2 : 1);
  ASSERT_EQ(cloud.lines, encoder.lasers());
  ASSERT_EQ(cloud.beams, columns);
  int misses = 0;
  for (int laser = 0; laser < encoder.lasers(); ++laser) {
    for (int beam = 0; beam < cloud.beams; ++beam) {
      const auto ring = static_cast<std::size_t>(RingOf(encoder, laser));
      const std::size_t i =
          ring * static_cast<std::size_t>(columns) + static_cast<std::size_t>(beam);
      ASSERT_EQ(cloud.ring[i], ring);
      const Eigen::Vector3d d = cloud.directions[i].cast<double>();
      ASSERT_NEAR(d.norm(), 1, 1e-6);
      const double azimuth = std::atan2(-d.y(), d.x()) / kDegree;
      const double elevation = std::asin(d.z()) / kDegree;
      ASSERT_NEAR(elevation, encoder.Elevation(laser), 0.01);
      const double truth = MadeUpDistance(encoder.Elevation(laser), azimuth);
      // Of another distance than at the edges of the sector of misses.
      const double a = std::fmod(azimuth + 360, 360);
      if (std::abs(a - 30) < 1e-3 || std::abs(a - 40) < 1e-3) continue;
      ASSERT_EQ(cloud.IsHit(i), truth > 0) << azimuth;
      misses += truth > 0 ? 0 : 1;
      if (truth == 0) continue;
      const double unit = model == Model::kVlp32c ? 0.004 : 0.002;
      ASSERT_NEAR(cloud.points[i].norm(), truth, unit / 2 + 1e-3) << azimuth;
      ASSERT_NEAR(cloud.intensity[i], MadeUpReflectivity(encoder.Elevation(laser), azimuth) / 255.0,
                  1.01 / 255);
    }
  }
  EXPECT_NEAR(misses, cloud.size() * 10 / 360.0, 0.01 * static_cast<double>(cloud.size()));
}

TEST_P(Velodyne, TimesAndAzimuthsBelongTogether) {
  const Model model = GetParam();
  const VelodyneEncoder encoder = Encoder(model);
  const Turned run = Revolve(model, encoder, 3 * encoder.PacketsPerTurn() + 2);
  ASSERT_EQ(run.clouds.size(), 2u);
  for (const Cloud& cloud : run.clouds) {
    EXPECT_EQ(cloud.sweep_utime, *std::min_element(cloud.utime.begin(), cloud.utime.end()));
    for (std::size_t i = 0; i < cloud.size(); i += 7) {
      const int laser = [&] {
        int l = 0;
        while (RingOf(encoder, l) != cloud.ring[i]) ++l;
        return l;
      }();
      // The head has turned evenly since the recording began.
      const Eigen::Vector3f& d = cloud.directions[i];
      const double passed = static_cast<double>(cloud.utime[i] - kJune2015);
      const double block_us =
          encoder.PacketDuration_us() / 12 * (model == Model::kHdl64e ? 2.0 : 1.0);
      const double head = 90 + passed / block_us * encoder.block_turn / 100;
      double off = std::atan2(-d.y(), d.x()) / kDegree - head;
      if (model == Model::kVlp32c)
        off -= velodyne::SensorOf(model).azimuth_deg[static_cast<std::size_t>(laser)];
      off -= 360 * std::round(off / 360);
      ASSERT_NEAR(off, 0, 0.01) << i;  // 3 us
    }
  }
}

TEST_P(Velodyne, LostPacketsLeaveTheirPlaces) {
  const Model model = GetParam();
  const VelodyneEncoder encoder = Encoder(model);
  const int turn = encoder.PacketsPerTurn();
  const Turned whole = Revolve(model, encoder, 3 * turn + 2);
  const Turned run = Revolve(model, encoder, 3 * turn + 2, [&](int i) {
    return i == turn / 2 || (i >= turn + turn / 4 && i < turn + turn / 4 + 3);  // one at the seam
  });
  EXPECT_EQ(run.sweeps.lost_packets(), 4);
  ASSERT_EQ(run.clouds.size(), whole.clouds.size());
  for (std::size_t c = 0; c < run.clouds.size(); ++c) {
    ASSERT_EQ(run.clouds[c].beams, whole.clouds[c].beams);
    EXPECT_NEAR(static_cast<double>(run.clouds[c].sweep_utime - whole.clouds[c].sweep_utime), 0, 2);
    for (std::size_t i = 0; i < run.clouds[c].size(); ++i) {
      if (!run.clouds[c].directions[i].allFinite()) continue;
      ASSERT_LT((run.clouds[c].directions[i] - whole.clouds[c].directions[i]).norm(), 1e-6);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Models, Velodyne,
                         ::testing::Values(Model::kVlp16, Model::kVlp32c, Model::kHdl32e),
                         [](const auto& info) {
                           const std::string& name = velodyne::SensorOf(info.param).name;
                           return name.substr(0, 3) + name.substr(4);
                         });

TEST(VelodyneHdl64e, BothHalvesMakeOneColumn) {
  VelodyneEncoder encoder = Encoder(Model::kHdl64e);
  const Turned run = Revolve(Model::kHdl64e, encoder, 3 * encoder.PacketsPerTurn() + 2);
  ASSERT_EQ(run.clouds.size(), 2u);
  const Cloud& cloud = run.clouds[0];
  EXPECT_EQ(cloud.lines, 64);
  EXPECT_EQ(cloud.beams, 1800);
  const velodyne::Sensor& sensor = velodyne::SensorOf(Model::kHdl64e);
  for (std::size_t laser = 0; laser < 64; ++laser) {
    // The made-up scene is by laser.
    const std::size_t i = static_cast<std::size_t>(sensor.ring[laser]) * 1800 + 900;
    EXPECT_NEAR(cloud.points[i].norm(), MadeUpDistance(-static_cast<double>(laser), 0), 0.02)
        << laser;
  }
  EXPECT_NEAR(std::asin(cloud.directions[0].z()) / kDegree, -24.33, 0.01);
  EXPECT_NEAR(std::asin(cloud.directions.back().z()) / kDegree, 2, 0.01);
  encoder.dual = true;
  const auto bytes = encoder.Packet(0);
  const auto packet = velodyne::Decode(sensor, bytes.data(), bytes.size());
  EXPECT_TRUE(packet.dual);
  EXPECT_EQ(packet.columns.size(), 3u);
}

TEST(VelodynePackets, DualKeepsTheReturnOfTheHigherReflectivity) {
  for (const Model model : {Model::kVlp16, Model::kVlp32c, Model::kHdl32e}) {
    VelodyneEncoder encoder = Encoder(model);
    const Turned single = Revolve(model, encoder, 3 * encoder.PacketsPerTurn() + 2);
    encoder.dual = true;  // the second returns are a metre farther and less reflective
    const Turned dual = Revolve(model, encoder, 3 * encoder.PacketsPerTurn() + 2);
    ASSERT_EQ(dual.clouds.size(), 2u);
    ASSERT_EQ(dual.clouds[0].size(), single.clouds[0].size());
    for (std::size_t i = 0; i < dual.clouds[0].size(); ++i) {
      ASSERT_EQ(dual.clouds[0].IsHit(i), single.clouds[0].IsHit(i));
      if (!dual.clouds[0].IsHit(i)) continue;
      ASSERT_LT((dual.clouds[0].points[i] - single.clouds[0].points[i]).norm(), 1e-5);
    }
  }
}

TEST(VelodynePackets, DualHasBothReturns) {
  for (const Model model : {Model::kVlp16, Model::kVlp32c, Model::kHdl32e, Model::kHdl64e}) {
    const velodyne::Sensor& sensor = velodyne::SensorOf(model);
    VelodyneEncoder encoder = Encoder(model);
    auto bytes = encoder.Packet(0);
    const auto single = velodyne::Decode(sensor, bytes.data(), bytes.size());
    for (const auto& column : single.columns) EXPECT_TRUE(column.second_returns.empty());
    encoder.dual = true;  // the second returns are a metre farther and less reflective
    bytes = encoder.Packet(0);
    const auto dual = velodyne::Decode(sensor, bytes.data(), bytes.size());
    std::size_t both = 0;
    for (const auto& column : dual.columns) {
      ASSERT_EQ(column.second_returns.size(), column.returns.size());
      for (std::size_t laser = 0; laser < column.returns.size(); ++laser) {
        const velodyne::Return &first = column.returns[laser],
                               &second = column.second_returns[laser];
        if (first.distance == 0 || second.distance == 0) continue;
        ++both;
        EXPECT_NEAR((second.distance - first.distance) * sensor.unit_m, 1, 2 * sensor.unit_m);
        EXPECT_LT(second.reflectivity, first.reflectivity);
      }
    }
    EXPECT_GT(both, 50U);
  }
}

std::string WhyNot(Model model, const std::vector<std::uint8_t>& bytes) {
  try {
    velodyne::Decode(velodyne::SensorOf(model), bytes.data(), bytes.size());
  } catch (const InputError& e) {
    return e.what();
  }
  return "good";
}

TEST(VelodynePackets, BadOnesAreRefusedWithAReason) {
  const auto good = Encoder(Model::kVlp16).Packet(0);
  EXPECT_EQ(WhyNot(Model::kVlp16, good), "good");
  EXPECT_THAT(WhyNot(Model::kHdl32e, good), HasSubstr("is of a VLP-16; correct the model"));
  EXPECT_THAT(WhyNot(Model::kVlp16, {}), HasSubstr("has 0 bytes"));
  auto bad = good;
  bad.pop_back();
  EXPECT_THAT(WhyNot(Model::kVlp16, bad), HasSubstr("has 1205 bytes"));
  bad = good;
  bad[100] = 0;
  EXPECT_THAT(WhyNot(Model::kVlp16, bad), HasSubstr("block 1"));
  bad = good;
  bad[3] = 0xff;
  EXPECT_THAT(WhyNot(Model::kVlp16, bad), HasSubstr("azimuth"));
}

TEST(VelodynePackets, RandomBytesDoNoHarm) {
  std::mt19937 random(5);
  VelodyneSweeps sweeps(Model::kVlp32c);
  const auto good = Encoder(Model::kVlp32c).Packet(0);
  for (int i = 0; i < 3000; ++i) {
    auto bytes = good;
    for (int c = 0; c < 1 + i % 50; ++c) bytes[random() % bytes.size()] = random() & 255;
    for (std::size_t b = 0; b < 12 && i % 2 == 0; ++b) {
      bytes[100 * b] = 0xff;
      bytes[100 * b + 1] = 0xee;
      bytes[100 * b + 3] = static_cast<std::uint8_t>(random() % 140);
    }
    try {
      const auto packet =
          velodyne::Decode(velodyne::SensorOf(Model::kVlp32c), bytes.data(), bytes.size());
      for (const Cloud& cloud : sweeps.Add(packet, kJune2015 + 1000 * i)) {
        EXPECT_EQ(cloud.size(), static_cast<std::size_t>(cloud.lines * cloud.beams));
      }
    } catch (const InputError&) {
    }
  }
}

TEST(VelodyneSweeps, AClockThatStandsStillLeavesTheArrivals) {
  VelodyneEncoder encoder = Encoder(Model::kVlp16);
  VelodyneSweeps sweeps(Model::kVlp16);
  std::vector<Cloud> clouds;
  for (int i = 0; i < 250; ++i) {
    auto bytes = encoder.Packet(i);
    std::fill(bytes.begin() + 1200, bytes.begin() + 1204, 0);
    const auto packet =
        velodyne::Decode(velodyne::SensorOf(Model::kVlp16), bytes.data(), bytes.size());
    for (Cloud& c : sweeps.Add(packet, kJune2015 + std::llround((i + 1) * 1327.104))) {
      clouds.push_back(std::move(c));
    }
  }
  ASSERT_GE(clouds.size(), 2u);
  EXPECT_NEAR(static_cast<double>(clouds[1].sweep_utime - clouds[0].sweep_utime), 75 * 1327.104, 5);
}

// The sensor's clock is 50 ppm slow, packets arrive late by chance.
TEST(VelodyneSweeps, WithinARevolutionTimesAreTheSensorsHoweverPacketsArrive) {
  constexpr double kDrift = 50e-6;
  constexpr int kTurns = 80;  // 8 s: a rate is fitted after 5
  const VelodyneEncoder encoder = Encoder(Model::kVlp16);
  std::mt19937 random(7);
  std::exponential_distribution<double> late_us(1 / 400.0);
  VelodyneSweeps sweeps(Model::kVlp16);
  std::vector<Cloud> clouds;
  for (int i = 0; i < kTurns * encoder.PacketsPerTurn(); ++i) {
    if (i % 50 == 20) continue;  // lost
    const auto bytes = encoder.Packet(i);
    const auto packet =
        velodyne::Decode(velodyne::SensorOf(Model::kVlp16), bytes.data(), bytes.size());
    const double sent_us = (i + 1) * encoder.PacketDuration_us() * (1 + kDrift);
    for (Cloud& c : sweeps.Add(packet, kJune2015 + std::llround(sent_us + late_us(random)))) {
      clouds.push_back(std::move(c));
    }
  }
  EXPECT_EQ(sweeps.clock_steps(), 0);
  ASSERT_GT(clouds.size(), kTurns - 3u);
  const double column_us = encoder.PacketDuration_us() / 24;
  for (const Cloud& cloud : clouds) {
    const auto beams = static_cast<std::size_t>(cloud.beams);
    const auto passed = static_cast<double>(cloud.utime[beams - 1] - cloud.utime[0]);
    const auto columns = static_cast<double>(beams - 1);
    EXPECT_NEAR(passed, columns * column_us, 2 + 500e-6 * passed);
    for (std::size_t c = 0; c < beams; ++c) {
      // To the microsecond that times and stamps are rounded to.
      ASSERT_NEAR(static_cast<double>(cloud.utime[c] - cloud.utime[0]),
                  passed * static_cast<double>(c) / columns, 2.5);
    }
  }
}

TEST(VelodyneSweeps, PacketsThatComeTwiceOrLateArePassedOver) {
  const VelodyneEncoder encoder = Encoder(Model::kVlp16);
  const Turned whole = Revolve(Model::kVlp16, encoder, 230);
  VelodyneSweeps sweeps(Model::kVlp16);
  std::vector<Cloud> clouds;
  for (int i = 0; i < 230; ++i) {
    for (const int number : {i, i, i - 2}) {
      if (number < 0) continue;
      const auto bytes = encoder.Packet(number);
      const auto packet =
          velodyne::Decode(velodyne::SensorOf(Model::kVlp16), bytes.data(), bytes.size());
      const auto arrival = kJune2015 + std::llround((i + 1) * encoder.PacketDuration_us());
      for (Cloud& c : sweeps.Add(packet, arrival)) clouds.push_back(std::move(c));
    }
  }
  ASSERT_EQ(clouds.size(), whole.clouds.size());
  for (std::size_t i = 0; i < clouds.size(); ++i) {
    EXPECT_EQ(clouds[i].beams, whole.clouds[i].beams);
    EXPECT_EQ(clouds[i].sweep_utime, whole.clouds[i].sweep_utime);
  }
}

}  // namespace
}  // namespace rgbdt
