#include "services/packets/recording.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calib/files/atomic_file.h"
#include "calib/files/points/cloud_files.h"
#include "calib/model/errors.h"
#include "services/drivers/ouster/ouster_packets.h"
#include "services/drivers/pcap/pcap_reader.h"
#include "tests/hardware/velodyne_encoder.h"
#include "tests/numbers.h"
#include "tests/unit/files/test_data.h"
#include "tests/unit/matchers.h"
#include "tests/unit/packets/ouster_encoder.h"
#include "tests/unit/packets/robosense_encoder.h"

namespace rgbdt {
namespace {

using test::OusterEncoder;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr Utime kRecorded = 1'700'000'000'000'000;

const char* const kProfiles[] = {"LEGACY", "RNG19_RFL8_SIG16_NIR16", "RNG19_RFL8_SIG16_NIR16_DUAL",
                                 "RNG15_RFL8_NIR8"};

// The manual's formula for a point, "XYZ calculation", in millimetres; then to the sensor's frame.
Eigen::Vector3d PointByTheManual(const OusterEncoder& o, int row, int column, double range_mm) {
  const double n = o.beam_origin_mm;
  const double theta_e = 2 * M_PI * (1 - static_cast<double>(column) / o.columns);
  const double theta_a = -2 * M_PI * o.azimuth_deg[static_cast<std::size_t>(row)] / 360;
  const double phi = 2 * M_PI * o.altitude_deg[static_cast<std::size_t>(row)] / 360;
  const double x =
      (range_mm - n) * std::cos(theta_e + theta_a) * std::cos(phi) + n * std::cos(theta_e);
  const double y =
      (range_mm - n) * std::sin(theta_e + theta_a) * std::cos(phi) + n * std::sin(theta_e);
  const double z = (range_mm - n) * std::sin(phi);
  return Eigen::Vector3d(-x, -y, z + o.height_mm) * 1e-3;
}

class Recordings : public testing::Test {
 protected:
  std::filesystem::path Save(const PcapWriter& writer) {
    writer.Save((dir_ / "x.pcap").string());
    return dir_ / "x.pcap";
  }
  // Whole turns of packets, some left out.
  std::filesystem::path Record(const OusterEncoder& encoder, int first, int count,
                               const std::vector<int>& left_out = {}) {
    WriteFileAtomically(dir_ / "os.json", encoder.Metadata());
    PcapWriter writer;
    writer.port = 7502;
    writer.Begin();
    const int in_turn = encoder.columns / encoder.columns_per_packet;
    for (int i = first; i < first + count; ++i) {
      if (std::count(left_out.begin(), left_out.end(), i) != 0) continue;
      writer.Add(kRecorded + 1600 * i, encoder.Packet(i / in_turn, i % in_turn));
    }
    return Save(writer);
  }
  Recording Read(const std::filesystem::path& path, RecordingOptions options = {}) {
    sweeps_.clear();
    return ReadRecording(path, options, [this](const Cloud& sweep) { sweeps_.push_back(sweep); });
  }

  test::TempDir dir_;
  std::vector<Cloud> sweeps_;
};

TEST_F(Recordings, AnOustersPointsLieWhereTheManualSays) {
  for (const char* profile : kProfiles) {
    for (const bool nested : {false, true}) {
      OusterEncoder encoder;
      encoder.profile = profile;
      encoder.nested = nested;
      const Recording recording = Read(Record(encoder, 0, 4), {dir_ / "os.json", 0});
      EXPECT_EQ(recording.sensor, "OS-0-4");
      EXPECT_EQ(recording.sender.port, 7502);
      EXPECT_EQ(recording.packets, 4);
      EXPECT_EQ(recording.lost, "");
      ASSERT_THAT(sweeps_, SizeIs(2)) << profile;
      const Cloud& sweep = sweeps_[1];
      ASSERT_EQ(sweep.lines, 4);
      ASSERT_EQ(sweep.beams, 32);
      for (int row = 0; row < 4; ++row) {
        for (int column = 0; column < 32; ++column) {
          const int beam = (column + encoder.shifts[static_cast<std::size_t>(row)] + 32) % 32;
          const auto i = static_cast<std::size_t>((3 - row) * 32 + beam);
          EXPECT_EQ(sweep.ring[i], 3 - row);
          const int range = encoder.range_mm(row, column);
          // Of two returns the second one counts where the first is none.
          const bool second = range == 0 && encoder.profile.find("DUAL") != std::string::npos;
          EXPECT_EQ(sweep.IsHit(i), range != 0 || second);
          const int reflectivity = second ? 99 : encoder.Reflectivity(row, column);
          EXPECT_NEAR(sweep.intensity[i], reflectivity / 255.0, 1e-6);
          const double at = second ? 1000 : range;
          if (at != 0) {
            EXPECT_THAT(sweep.points[i].cast<double>(),
                        EigenNear(PointByTheManual(encoder, row, column, at), 2e-6));
          }
          const Eigen::Vector3d far = PointByTheManual(encoder, row, column, 1e9);
          EXPECT_THAT(sweep.directions[i].cast<double>(), EigenNear(far.normalized(), 1e-6));
          EXPECT_NEAR(static_cast<double>(sweep.utime[i] - sweep.sweep_utime), column * 97.0, 2);
        }
      }
    }
  }
}

// The head's angle is that of the beam's place in the grid, and beam 0 looks back.
TEST_F(Recordings, NeighboursInAnOustersGridAreNeighboursInAngle) {
  OusterEncoder encoder;
  encoder.azimuth_deg = {22.5, 11.25, 0, -11.25};  // as the shifts say
  encoder.range_mm = [](int, int) { return 50'000; };
  Read(Record(encoder, 0, 2), {dir_ / "os.json", 0});
  ASSERT_THAT(sweeps_, SizeIs(1));
  for (std::size_t i = 0; i < sweeps_[0].size(); ++i) {
    const Eigen::Vector3f& d = sweeps_[0].directions[i];
    const double clockwise_from_back = M_PI - std::atan2(d.y(), d.x());
    const double expected = static_cast<double>(i % 32) * 2 * M_PI / 32;
    EXPECT_NEAR(std::remainder(clockwise_from_back - expected, 2 * M_PI), 0, 1e-5);
  }
}

TEST_F(Recordings, WhatOfAnOusterIsLostIsCountedAndTheFirstCutTurnLeftOut) {
  OusterEncoder encoder;
  // From the middle of turn 0 on; a packet of turn 2 is missing; turn 3 ends early.
  const Recording recording = Read(Record(encoder, 1, 6, {4}), {dir_ / "os.json", 0});
  EXPECT_EQ(recording.sweeps, 2);
  EXPECT_EQ(recording.lost, "16 columns never came, or were not measured");
  const Cloud& torn = sweeps_.at(1);
  EXPECT_EQ(LostLines(torn), 0);
  EXPECT_TRUE(std::isnan(torn.directions[0].x())) << "nothing is known of a beam that never came";
  EXPECT_FALSE(std::isnan(torn.directions[20].x()));
}

TEST_F(Recordings, AClockThatShowsTheTimeIsTaken) {
  OusterEncoder encoder;
  encoder.first_ns = 1'650'000'000'123'456'000;
  Read(Record(encoder, 0, 2), {dir_ / "os.json", 0});
  EXPECT_EQ(sweeps_.at(0).sweep_utime, 1'650'000'000'123'456);
}

TEST_F(Recordings, AClockOfPtpIsLaidOnUtc) {
  OusterEncoder encoder;
  encoder.first_ns = (kRecorded + 37'000'000) * 1000;
  Read(Record(encoder, 0, 6), {dir_ / "os.json", 0});
  ASSERT_THAT(sweeps_, SizeIs(3));
  EXPECT_EQ(sweeps_[0].sweep_utime, kRecorded);
  EXPECT_EQ(sweeps_[2].sweep_utime, kRecorded + 2 * 32 * 97);
}

TEST_F(Recordings, AVelodyneIsKnownByItsPackets) {
  const VelodyneEncoder encoder = MadeUpVelodyne(VelodyneEncoder::Model::kVlp16);
  PcapWriter writer;
  writer.Begin();
  for (int i = 0; i < 3 * encoder.PacketsPerTurn(); ++i) {
    writer.Add(kRecorded + static_cast<Utime>(i * encoder.PacketDuration_us()), encoder.Packet(i));
  }
  const Recording recording = Read(Save(writer));
  EXPECT_EQ(recording.sensor, "VLP-16");
  EXPECT_EQ(recording.sender.port, 2368);
  EXPECT_GE(recording.sweeps, 1);
  EXPECT_EQ(sweeps_.at(0).lines, 16);
}

// The angles come a while after the first packets.
TEST_F(Recordings, ARobosenseTellsItsAnglesOnAPortOfTheirOwn) {
  const test::RobosenseEncoder encoder{test::RobosenseEncoder::Model::kHelios};
  PcapWriter writer;
  writer.Begin();
  for (int i = 0; i < 4 * 30; ++i) {
    const auto us = static_cast<int>(encoder.packet_us() * i);
    writer.port = 7788;
    if (i == 5) writer.Add(kRecorded + us - 1, encoder.Information());
    writer.port = 6699;
    writer.Add(kRecorded + us, encoder.Packet(1200 * i % 36000, us));
  }
  const Recording recording = Read(Save(writer));
  EXPECT_EQ(recording.sensor, "RS-Helios-5515");
  EXPECT_EQ(recording.sender.port, 6699);
  EXPECT_THAT(recording.others, IsEmpty());
  EXPECT_EQ(recording.packets, 4 * 30 + 1);
  EXPECT_EQ(recording.lost, "5 packets came before one that told the angles");
  ASSERT_THAT(sweeps_, SizeIs(3));
  EXPECT_EQ(sweeps_[0].beams, 360);
}

TEST_F(Recordings, OfTwoLidarsOnOnePortTheOneOfMorePacketsIsTaken) {
  const VelodyneEncoder encoder = MadeUpVelodyne(VelodyneEncoder::Model::kVlp16);
  const auto record = [&](bool other_too) {
    PcapWriter writer;
    writer.Begin();
    for (int i = 0; i < 3 * encoder.PacketsPerTurn(); ++i) {
      const Utime utime = kRecorded + static_cast<Utime>(i * encoder.PacketDuration_us());
      writer.from = {192, 168, 1, 201};
      writer.Add(utime, encoder.Packet(i));
      writer.from = {192, 168, 1, 202};
      if (other_too && i % 2 == 0) writer.Add(utime + 50, encoder.Packet(i + 30));
    }
    return Save(writer);
  };
  Read(record(false));
  const std::vector<Cloud> alone = sweeps_;
  const Recording recording = Read(record(true));
  EXPECT_EQ(recording.sender.from, "192.168.1.201");
  EXPECT_EQ(recording.packets, 3 * encoder.PacketsPerTurn());
  EXPECT_EQ(recording.lost, "");
  ASSERT_THAT(recording.others, SizeIs(1));
  EXPECT_EQ(recording.others.begin()->first.from, "192.168.1.202");
  ASSERT_EQ(sweeps_.size(), alone.size());
  for (std::size_t i = 0; i < alone.size(); ++i) {
    EXPECT_EQ(sweeps_[i].sweep_utime, alone[i].sweep_utime);
    EXPECT_EQ(sweeps_[i].size(), alone[i].size());
  }
}

TEST_F(Recordings, BecomePcdFilesNamedByTheirTimes) {
  OusterEncoder encoder;
  encoder.first_ns = kRecorded * 1000;
  const auto path = Record(encoder, 0, 4);
  WriteRecordingAsPcds(path, {dir_ / "os.json", 0}, dir_ / "out");
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(dir_ / "out")) {
    names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  EXPECT_THAT(names, ElementsAre("1700000000.000000.pcd", "1700000000.003104.pcd"));
  EXPECT_EQ(ReadSweep(dir_ / "out" / names[0]).beams, 32);
  EXPECT_THAT(test::ErrorOf([&] {
                WriteRecordingAsPcds(path, {dir_ / "os.json", 0}, dir_ / "out");
              }),
              HasSubstr("not empty"));
}

TEST_F(Recordings, WithoutAKnownLidarItIsSaidWhatIsThere) {
  OusterEncoder encoder;
  const auto path = Record(encoder, 0, 4);
  EXPECT_THAT(test::ErrorOf([&] { Read(path); }),
              testing::AllOf(HasSubstr("--metadata"), HasSubstr("7502 (4)")));
  EXPECT_THAT(test::ErrorOf([&] { Read(path, {dir_ / "os.json", 99}); }), HasSubstr("port 99"));
  encoder.rows = 3;
  encoder.shifts.pop_back();
  encoder.altitude_deg.pop_back();
  encoder.azimuth_deg.pop_back();
  WriteFileAtomically(dir_ / "other.json", encoder.Metadata());
  EXPECT_THAT(test::ErrorOf([&] { Read(path, {dir_ / "other.json", 0}); }), HasSubstr("OS-0-4"));
}

TEST_F(Recordings, CutOffAnywhereGivesWhatLiesBefore) {
  OusterEncoder encoder;
  const auto path = Record(encoder, 0, 6);
  const std::string whole = ReadWholeFile(path);
  std::int64_t most = 0;
  for (std::size_t size = 24; size < whole.size(); size += 97) {
    WriteFileAtomically(dir_ / "cut.pcap", whole.substr(0, size));
    try {
      const Recording recording = Read(dir_ / "cut.pcap", {dir_ / "os.json", 0});
      EXPECT_GE(recording.sweeps, most);
      most = recording.sweeps;
      EXPECT_THAT(recording.cut_off.empty() ? "cut short" : recording.cut_off,
                  HasSubstr("cut short"));
    } catch (const InputError&) {
      EXPECT_EQ(most, 0);  // no packet yet
    }
  }
  EXPECT_EQ(most, 2);
}

TEST_F(Recordings, HolesOfASparseFileEndIt) {
  OusterEncoder encoder;
  const auto path = Record(encoder, 0, 4);
  std::filesystem::resize_file(path, 10'000'000'000);
  const Recording recording = Read(path, {dir_ / "os.json", 0});
  EXPECT_EQ(recording.sweeps, 2);
  EXPECT_THAT(recording.cut_off, HasSubstr("a packet of no bytes"));
}

TEST(OusterMetadata, WhatIsWrongWithItIsSaid) {
  const OusterEncoder encoder;
  const auto why = [&](const std::string& from, const std::string& to) {
    std::string text = encoder.Metadata();
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
    return test::ErrorOf([&] { ouster::ParseMetadata(text, "os.json"); });
  };
  EXPECT_THAT(why("columns_per_frame", "x"), HasSubstr("has no columns_per_frame"));
  EXPECT_THAT(why("\"columns_per_frame\":32", "\"columns_per_frame\":1e9"),
              HasSubstr("columns_per_frame is 1000000000.0"));
  EXPECT_THAT(why("\"columns_per_packet\":16", "\"columns_per_packet\":0"), HasSubstr("1 to 64"));
  EXPECT_THAT(why("[2,1,0,-1]", "[2,1,0]"), HasSubstr("list of 4 numbers"));
  EXPECT_THAT(why("[2,1,0,-1]", "[2,1,0,\"x\"]"), HasSubstr("list of 4 numbers"));
  EXPECT_THAT(why("[-1,0", "[-9,0"), HasSubstr("no rotation"));
  EXPECT_THAT(why("\"data_format\":{", "\"data_format\":{\"udp_profile_lidar\":\"NEW\","),
              HasSubstr("NEW"));
  EXPECT_THAT(test::ErrorOf([] { ouster::ParseMetadata("[]", "os.json"); }),
              HasSubstr("no JSON object"));
  EXPECT_THAT(test::ErrorOf([] { ouster::ParseMetadata(std::string(1'000'000, '['), "os.json"); }),
              HasSubstr("os.json"));
}

// Any byte may be any other.
TEST(OusterPackets, DamagedOnesAreDecodedOrRefused) {
  for (const char* profile : kProfiles) {
    OusterEncoder encoder;
    encoder.profile = profile;
    const ouster::Metadata metadata = ouster::ParseMetadata(encoder.Metadata(), "os.json");
    const auto whole = encoder.Packet(7, 1);
    ASSERT_EQ(whole.size(), metadata.PacketBytes());
    int refused = 0;
    for (std::size_t at = 0; at < whole.size(); ++at) {
      auto damaged = whole;
      damaged[at] ^= 0xff;
      try {
        EXPECT_THAT(ouster::Decode(metadata, damaged.data(), damaged.size()).columns, SizeIs(16));
      } catch (const InputError&) {
        ++refused;
      }
    }
    EXPECT_EQ(refused, 32) << "of each column's place either byte";
    EXPECT_THROW(ouster::Decode(metadata, whole.data(), whole.size() - 1), InputError);
  }
}

// IPv4 without a link layer (LINKTYPE_RAW), cut into fragments.
class Fragmented : public Recordings {
 protected:
  Fragmented() {
    Add32(0xa1b2c3d4);
    Add32(2 | 4 << 16);
    for (const std::uint32_t word : {0U, 0U, 65535U, 101U}) Add32(word);
  }
  void Add32(std::uint32_t word) {
    for (int i = 0; i < 4; ++i) bytes_ += static_cast<char>(word >> (8 * i));
  }
  void AddFragment(const std::string& datagram, int number, std::size_t from, std::size_t to) {
    const bool more = to < datagram.size();
    const std::size_t size = 20 + to - from, place = from / 8 | (more ? 0x2000 : 0);
    Add32(second_);
    Add32(static_cast<std::uint32_t>(frames_++));
    Add32(static_cast<std::uint32_t>(size));
    Add32(static_cast<std::uint32_t>(size));
    const auto high = [](std::size_t x) { return static_cast<char>(x >> 8); };
    const auto low = [](std::size_t x) { return static_cast<char>(x); };
    const auto n = static_cast<std::size_t>(number);
    bytes_ += {0x45, 0, high(size), low(size), high(n), low(n), high(place), low(place), 64, 17,
               0,    0, 10,         0,         0,       1,      10,          0,          0,  2};
    bytes_ += datagram.substr(from, to - from);
  }
  // A UDP datagram to port 7502.
  static std::string Udp(const std::string& payload) {
    const std::size_t size = 8 + payload.size();
    return std::string{
               0x1d, 0x4d, 0x1d, 0x4e, static_cast<char>(size >> 8), static_cast<char>(size),
               0,    0} +
           payload;
  }
  std::vector<std::string> Payloads() {
    WriteFileAtomically(dir_ / "f.pcap", bytes_);
    PcapReader reader((dir_ / "f.pcap").string());
    std::vector<std::string> payloads;
    while (const auto datagram = reader.Next()) {
      EXPECT_EQ(datagram->port, 7502);
      EXPECT_FALSE(datagram->cut);
      payloads.emplace_back(datagram->payload.begin(), datagram->payload.end());
    }
    return payloads;
  }

  std::string bytes_;
  std::uint32_t second_ = 1'700'000'000;
  int frames_ = 0;
};

TEST_F(Fragmented, PiecesAreJoinedInAnyOrderAndOfSeveralAtOnce) {
  const std::string a(3000, 'a'), b(2000, 'b');
  const std::string first = Udp(a), second = Udp(b);
  AddFragment(first, 1, 1480, 2960);
  AddFragment(second, 2, 0, 1480);
  AddFragment(first, 1, 0, 1480);
  AddFragment(first, 1, 0, 1480);  // seen twice
  AddFragment(second, 2, 1480, second.size());
  AddFragment(first, 1, 2960, first.size());
  const std::string whole = Udp("whole");
  AddFragment(whole, 3, 0, whole.size());
  EXPECT_THAT(Payloads(), ElementsAre(b, a, "whole"));
}

TEST_F(Fragmented, WhatNeverEndsIsForgotten) {
  const std::string large = Udp(std::string(3000, 'x'));
  for (int i = 0; i < 2000; ++i) AddFragment(large, i, 1480, 2960);
  AddFragment(large, 1999, 0, 1480);
  AddFragment(large, 0, 0, 1480);  // forgotten: of this only the first piece is known now
  AddFragment(large, 1999, 2960, large.size());
  EXPECT_THAT(Payloads(), SizeIs(1));
}

TEST_F(Fragmented, ANumberUsedAnewIsAnotherPacket) {
  const std::string old = Udp(std::string(3000, 'o')), fresh = Udp(std::string(3000, 'n'));
  AddFragment(old, 1, 0, 1480);
  AddFragment(old, 1, 2960, old.size());  // what is between was lost
  second_ += 3;
  AddFragment(fresh, 1, 1480, 2960);
  AddFragment(fresh, 1, 2960, fresh.size());
  AddFragment(fresh, 1, 0, 1480);
  EXPECT_THAT(Payloads(), ElementsAre(std::string(3000, 'n')));
}

TEST_F(Fragmented, WhatLiesBeyondTheEndIsNoPartOfIt) {
  std::string datagram = Udp(std::string(3000, 'x'));
  datagram[4] = 20;  // says that it has 5 kB
  AddFragment(datagram, 1, 0, 1480);
  AddFragment(std::string(9000, 'y'), 1, 4000, 5000);
  AddFragment(datagram, 1, 1480, datagram.size());
  WriteFileAtomically(dir_ / "f.pcap", bytes_);
  PcapReader reader((dir_ / "f.pcap").string());
  const auto joined = reader.Next();
  ASSERT_TRUE(joined);
  EXPECT_TRUE(joined->cut);
  EXPECT_EQ(std::string(joined->payload.begin(), joined->payload.end()), std::string(3000, 'x'));
}

TEST_F(Fragmented, APipeIsNotWaitedFor) {
  EXPECT_THAT(test::ErrorOf([] { PcapReader("/dev/null"); }), HasSubstr("no regular file"));
}

}  // namespace
}  // namespace rgbdt
