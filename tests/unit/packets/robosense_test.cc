#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/drivers/packets/packet_sweeps.h"
#include "services/drivers/robosense/robosense_packets.h"
#include "tests/numbers.h"
#include "tests/unit/files/test_data.h"
#include "tests/unit/matchers.h"
#include "tests/unit/packets/robosense_encoder.h"

namespace rgbdt {
namespace {

using test::RobosenseEncoder;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using RsModel = RobosenseEncoder::Model;

constexpr Utime kRobosenseSecond = RobosenseEncoder::kSecond;

// A turn and a half from the front on.
std::vector<Cloud> RobosenseTurns(const RobosenseEncoder& encoder, PacketSweeps* sweeps) {
  std::vector<Cloud> done;
  const bool pairs = encoder.dual && encoder.model != RsModel::kRs16;
  const int step = RobosenseEncoder::kStep * (pairs ? 6 : 12);
  for (int i = 0; i * step <= 36000 + 18000 + step; ++i) {
    const int us = static_cast<int>(encoder.packet_us() * i);
    for (Cloud& cloud : sweeps->Add(encoder.Packet(i * step % 36000, us), kRobosenseSecond + us)) {
      done.push_back(std::move(cloud));
    }
  }
  return done;
}

std::unique_ptr<PacketSweeps> Told(const RobosenseEncoder& encoder) {
  auto sweeps = RobosensePackets();
  EXPECT_THAT(sweeps->Add(encoder.Information(), kRobosenseSecond), IsEmpty());
  return sweeps;
}

// Of the manuals: outwards and upwards [m], and when a slot is fired [us].
Eigen::Vector2d LensOf(RsModel model) {
  const Eigen::Vector2d lenses[] = {
      {0.03825, 0}, {0.03997, 0}, {0.01473, 0.09427}, {0.01619, 0.09571}, {0.03498, 0}};
  return lenses[static_cast<int>(model)];
}
double SlotTime_us(RsModel model, int slot) {
  switch (model) {
    case RsModel::kRs16:
      return slot < 16 ? 2.8 * slot : 55.5 + 2.8 * (slot - 16);
    case RsModel::kRs32:
      return 2.88 * (slot % 16) + (slot % 16 == 15 ? 1.44 : 0) + (slot < 16 ? 0 : 1.44);
    case RsModel::kBpearl:
      return 2.56 * (slot % 8) + (slot % 16 < 8 ? 0 : 25.68) + (slot < 16 ? 0 : 1.28);
    case RsModel::kBpearl4:
      return 1.668 * slot;
    case RsModel::kHelios:
      return 1.73 * slot;
  }
  return 0;
}

// Of each block and slot the point, wherever it lies in the revolution.
void ExpectSlot(const RobosenseEncoder& encoder, const Cloud& sweep, int azimuth, int slot) {
  const bool is16 = encoder.model == RsModel::kRs16;
  const int channel = slot % encoder.channels();
  const double block_us = encoder.block_us() * (is16 && encoder.dual ? 0.5 : 1);
  const double head =
      (azimuth + RobosenseEncoder::kStep * SlotTime_us(encoder.model, slot) / block_us) / 100 *
      kDegree;
  const double a = head + encoder.Azimuth_deg(channel) * kDegree,
               e = encoder.Elevation_deg(channel) * kDegree;
  const Eigen::Vector3d direction(std::cos(e) * std::cos(a), -std::cos(e) * std::sin(a),
                                  std::sin(e));
  const Eigen::Vector2d lens = LensOf(encoder.model);
  const int distance = encoder.Distance(azimuth, slot) + (encoder.dual ? 200 : 0);
  const Eigen::Vector3d point =
      Eigen::Vector3d(lens.x() * std::cos(head), -lens.x() * std::sin(head), lens.y()) +
      distance * encoder.unit_m() * direction;
  bool found = false;
  for (std::size_t i = 0; i < sweep.size() && !found; ++i) {
    if (azimuth == 9000) {
      found = !sweep.IsHit(i) && (sweep.directions[i].cast<double>() - direction).norm() < 1e-6;
    } else {
      found = (sweep.points[i].cast<double>() - point).norm() < 1e-6;
    }
  }
  EXPECT_TRUE(found) << azimuth << " " << slot;
}

TEST(RobosenseSweeps, PointsLieWhereTheManualsSay) {
  for (const RsModel model : RobosenseEncoder::kAll) {
    for (const bool dual : {false, true}) {
      SCOPED_TRACE(testing::Message() << static_cast<int>(model) << (dual ? " dual" : ""));
      const RobosenseEncoder encoder{model, dual};
      const auto packets = Told(encoder);
      const std::vector<Cloud> sweeps = RobosenseTurns(encoder, packets.get());
      ASSERT_THAT(sweeps, SizeIs(1));
      EXPECT_EQ(sweeps[0].lines, encoder.channels());
      EXPECT_EQ(sweeps[0].beams, model == RsModel::kRs16 && !dual ? 720 : 360);
      for (const int azimuth : {500, 9000, 20000, 35900}) {
        for (int slot = 0; slot < (dual && model == RsModel::kRs16 ? 16 : 32); ++slot) {
          ExpectSlot(encoder, sweeps[0], azimuth, slot);
        }
      }
    }
  }
}

TEST(RobosenseSweeps, AFileSaysTheSameAsItsPackets) {
  for (const RsModel model : {RsModel::kRs16, RsModel::kHelios}) {
    const RobosenseEncoder encoder{model};
    const auto by_file = PacketsByMetadata(encoder.Angles(), "angle.csv"), told = Told(encoder);
    const std::vector<Cloud> a = RobosenseTurns(encoder, by_file.get()),
                             b = RobosenseTurns(encoder, told.get());
    ASSERT_THAT(a, SizeIs(1));
    ASSERT_THAT(b, SizeIs(1));
    for (std::size_t i = 0; i < a[0].size(); ++i) {
      ASSERT_EQ(a[0].IsHit(i), b[0].IsHit(i));
      if (!a[0].IsHit(i)) continue;
      ASSERT_THAT(a[0].points[i], EigenNear(b[0].points[i], 1e-5));
    }
  }
}

TEST(RobosenseSweeps, TimesAreTheSensorsUnlessItsClockWasNeverSet) {
  for (const RsModel model : RobosenseEncoder::kAll) {
    RobosenseEncoder encoder{model};
    const Cloud sweep = RobosenseTurns(encoder, Told(encoder).get()).at(0);
    // A turn takes 30 packets: the back is the first of the sixteenth.
    EXPECT_NEAR(static_cast<double>(sweep.sweep_utime), kRobosenseSecond + 15 * encoder.packet_us(),
                1.01);
    encoder.has_date = false;
    EXPECT_NEAR(static_cast<double>(RobosenseTurns(encoder, Told(encoder).get()).at(0).sweep_utime),
                kRobosenseSecond + 15 * encoder.packet_us(), 1.01);
  }
}

TEST(RobosensePackets, BeamsFireWhenTheManualsSay) {
  for (const RsModel model : RobosenseEncoder::kAll) {
    const RobosenseEncoder encoder{model};
    const auto bytes = encoder.Packet(700, 5);
    const robosense::Sensor& sensor = *robosense::SensorOf(bytes.data(), bytes.size());
    const auto packet = robosense::Decode(sensor, false, bytes.data(), bytes.size());
    ASSERT_THAT(packet.columns, SizeIs(encoder.columns()));
    EXPECT_EQ(packet.utime, kRobosenseSecond + 5);
    for (int block = 0; block < 12; ++block) {
      for (int slot = 0; slot < 32; ++slot) {
        const bool is16 = model == RsModel::kRs16;
        const auto& column =
            packet.columns[static_cast<std::size_t>(is16 ? 2 * block + slot / 16 : block)];
        const auto& back = column.returns[static_cast<std::size_t>(slot % encoder.channels())];
        EXPECT_NEAR(column.time_us + back.after_us,
                    block * encoder.block_us() + SlotTime_us(model, slot), 0.005);
      }
    }
  }
}

// What is left out of a turn takes its time, and turns nothing within a block.
TEST(RobosensePackets, ASectorThatIsLeftOutIsPassedOver) {
  const RobosenseEncoder encoder{RsModel::kHelios};
  auto bytes = encoder.Packet(700, 0);
  const int azimuth = 700 + 300;  // of the second block on: three steps instead of one
  for (std::size_t block = 1; block < 12; ++block) {
    const int there = azimuth + 100 * (static_cast<int>(block) - 1);
    bytes[42 + 100 * block + 2] = static_cast<std::uint8_t>(there >> 8);
    bytes[42 + 100 * block + 3] = static_cast<std::uint8_t>(there);
  }
  const robosense::Sensor& sensor = *robosense::SensorOf(bytes.data(), bytes.size());
  const auto packet = robosense::Decode(sensor, false, bytes.data(), bytes.size());
  EXPECT_NEAR(packet.columns[1].time_us, 3 * 55.56, 1e-9);
  EXPECT_NEAR(packet.columns[2].time_us, 4 * 55.56, 1e-9);
  EXPECT_NEAR(packet.columns[0].returns[31].turned_rad, kDegree * 53.63 / 55.56, 1e-6);
}

TEST(RobosensePackets, BeforeTheAnglesTheyArePassedOverAndThatIsSaid) {
  const RobosenseEncoder encoder{RsModel::kRs32};
  const auto sweeps = RobosensePackets();
  EXPECT_EQ(sweeps->name(), "RoboSense");
  ASSERT_TRUE(sweeps->IsOurs(encoder.Packet(0, 0)));
  EXPECT_THAT(RobosenseTurns(encoder, sweeps.get()), IsEmpty());
  EXPECT_EQ(sweeps->name(), "RS-LiDAR-32");
  EXPECT_THAT(sweeps->Lost(), HasSubstr("packets came before one that told the angles"));
  EXPECT_THAT(test::ErrorOf([&] {
                for (int i = 0; i < 3000; ++i) sweeps->Add(encoder.Packet(0, 0), 0);
              }),
              HasSubstr("DIFOP"));
  sweeps->Add(encoder.Information(), 0);
  EXPECT_THAT(RobosenseTurns(encoder, sweeps.get()), SizeIs(1));
  EXPECT_FALSE(sweeps->IsOurs(RobosenseEncoder{RsModel::kHelios}.Packet(0, 0)));
}

TEST(RobosensePackets, DamagedOnesAreDecodedOrRefused) {
  for (const RsModel model : RobosenseEncoder::kAll) {
    const auto whole = RobosenseEncoder{model}.Packet(100, 5);
    const robosense::Sensor& sensor = *robosense::SensorOf(whole.data(), whole.size());
    int refused = 0;
    for (std::size_t at = 0; at < whole.size(); ++at) {
      auto damaged = whole;
      damaged[at] ^= 0xff;
      try {
        robosense::Decode(sensor, false, damaged.data(), damaged.size());
      } catch (const InputError&) {
        ++refused;
      }
    }
    EXPECT_GE(refused, 3 * 12 + 5);  // flags, an azimuth's high byte, the head
    EXPECT_LE(refused, 4 * 12 + 11);
    EXPECT_THROW(robosense::Decode(sensor, false, whole.data(), whole.size() - 1), InputError);
    EXPECT_EQ(robosense::SensorOf(whole.data(), 0), nullptr);
  }
}

TEST(RobosenseAngles, WhatIsWrongIsSaid) {
  const auto why = [](const std::string& csv) {
    return test::ErrorOf([&] { PacketsByMetadata(csv, "angle.csv"); });
  };
  EXPECT_THAT(why("1,2\n"), HasSubstr("of 1 channels"));
  EXPECT_THAT(why("1,2\n100,2\n"), HasSubstr("angle.csv:2"));
  EXPECT_THAT(why("1,2\n1,x\n"), HasSubstr("angle.csv:2"));
  const RobosenseEncoder encoder{RsModel::kHelios};
  auto none = encoder.Information();
  std::fill(none.begin() + 468, none.begin() + 468 + 96, 0xff);
  const auto sweeps = RobosensePackets();
  sweeps->Add(encoder.Packet(0, 0), 0);
  EXPECT_THAT(test::ErrorOf([&] { sweeps->Add(none, 0); }), HasSubstr("no angles"));
}

}  // namespace
}  // namespace rgbdt
