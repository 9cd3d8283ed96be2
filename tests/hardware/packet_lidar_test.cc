// Ouster, Hesai and Livox by rgbdt-lidar, from the network and from recordings. What is in a sweep
// is tests/unit/packets' to test: here it is the same sweep that its decoder gives.
#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <memory>

#include "calib/files/atomic_file.h"
#include "calib/model/errors.h"
#include "calib/scan_assembly/sweep_chunks.h"
#include "services/drivers/lidar/lidar_node.h"
#include "services/drivers/packets/packet_source.h"
#include "services/posix/clock.h"
#include "tests/hardware/device_harness.h"
#include "tests/hardware/udp_sender.h"
#include "tests/hardware/velodyne_encoder.h"
#include "tests/unit/packets/hesai_encoder.h"
#include "tests/unit/packets/livox_encoder.h"
#include "tests/unit/packets/ouster_encoder.h"
#include "tests/unit/packets/robosense_encoder.h"

namespace rgbdt {
namespace {

using test::HesaiEncoder;
using test::LivoxEncoder;
using test::OusterEncoder;
using test::RobosenseEncoder;
using ::testing::HasSubstr;
using ::testing::SizeIs;
using ::testing::ThrowsMessage;
using Make = PacketLidarDevice::Make;
using Payload = PacketSweeps::Payload;
namespace fs = std::filesystem;

constexpr Utime kRecorded = 1'700'000'000'000'000;

struct Sent {
  Utime after_us;
  Payload payload;
};

// A packet of 128 beams.
OusterEncoder LargeOuster() {
  OusterEncoder encoder;
  encoder.rows = 128;
  encoder.shifts.assign(128, 0);
  encoder.azimuth_deg.assign(128, 0);
  encoder.altitude_deg.clear();
  for (int row = 0; row < 128; ++row) encoder.altitude_deg.push_back(22 - 0.35 * row);
  return encoder;
}

std::vector<Sent> Packets(const OusterEncoder& encoder, int turns) {
  std::vector<Sent> sent;
  const int in_turn = encoder.columns / encoder.columns_per_packet;
  for (int i = 0; i < turns * in_turn; ++i) {
    sent.push_back(
        {97 * encoder.columns_per_packet * (i + 1), encoder.Packet(i / in_turn, i % in_turn)});
  }
  return sent;
}

std::vector<Sent> Packets(const RobosenseEncoder& encoder, int turns) {
  std::vector<Sent> sent;
  for (int i = 0; i < turns * 30 + 20; ++i) {
    const int us = static_cast<int>(encoder.packet_us() * i);
    sent.push_back({us, encoder.Packet(1200 * i % 36000, us)});
  }
  return sent;
}

std::vector<Sent> Packets(const HesaiEncoder& encoder, int turns) {
  std::vector<Sent> sent;
  for (int i = 0; i < 45 * turns + 30; ++i) {
    sent.push_back({400 * (i + 1), encoder.Packet(800 * i % 36000, 400 * i)});
  }
  return sent;
}

std::vector<Sent> Packets(const LivoxEncoder& encoder) {
  std::vector<Sent> sent;
  for (int i = 0; i < encoder.PacketsPerSecond() + 20; ++i) {
    sent.push_back({encoder.period_us() * (i + 1), encoder.Packet(i)});
  }
  return sent;
}

std::vector<Cloud> Decoded(PacketSweeps* sweeps, const std::vector<Sent>& sent) {
  std::vector<Cloud> done;
  for (const Sent& packet : sent) {
    for (Cloud& sweep : sweeps->Add(packet.payload, kRecorded + packet.after_us)) {
      done.push_back(std::move(sweep));
    }
  }
  if (auto sweep = sweeps->Finish()) done.push_back(std::move(*sweep));
  return done;
}

std::vector<Cloud> Joined(const Collected& collected) {
  std::vector<Cloud> sweeps;
  std::vector<CloudChunk> chunks;
  for (const CloudChunk& chunk : collected.All<CloudChunk>()) {
    chunks.push_back(chunk);
    if (chunk.sweep_end) sweeps.push_back(JoinChunks(std::exchange(chunks, {})));
  }
  return sweeps;
}

class PacketLidar : public ::testing::Test {
 protected:
  PacketLidar() {
    std::string name = (fs::temp_directory_path() / "rgbdt_packets_XXXXXX").string();
    dir_ = mkdtemp(name.data());
  }
  ~PacketLidar() override { fs::remove_all(dir_); }

  std::string Write(const std::string& name, const std::string& text) const {
    WriteFileAtomically(dir_ / name, text);
    return (dir_ / name).string();
  }
  std::string Record(int port, const std::vector<Sent>& sent) const {
    PcapWriter writer;
    writer.port = port;
    writer.Begin();
    for (const Sent& packet : sent) writer.Add(kRecorded + packet.after_us, packet.payload);
    writer.Save((dir_ / "recording.pcap").string());
    return (dir_ / "recording.pcap").string();
  }
  // What rgbdt-lidar makes of a recording is what the decoder makes of it.
  void ExpectAsDecoded(PacketLidarDevice device, const std::vector<Sent>& sent,
                       PacketSweeps* decoder, std::size_t sweeps) const {
    device.port = DefaultPort(device.make);
    device.pcap = Record(device.port, sent);
    LidarSpec lidar;
    lidar.device = device;
    LidarNode node(lidar);
    Collected collected;
    ASSERT_TRUE(Collect(&node, &collected, [&](const Collected&) { return node.finished(); }));
    const std::vector<Cloud> expected = Decoded(decoder, sent), found = Joined(collected);
    ASSERT_THAT(expected, SizeIs(sweeps));
    ASSERT_THAT(found, SizeIs(sweeps));
    for (std::size_t i = 0; i < sweeps; ++i) {
      EXPECT_EQ(found[i].sweep_utime, expected[i].sweep_utime);
      EXPECT_EQ(found[i].organised, expected[i].organised);
      ASSERT_GE(found[i].size(), expected[i].size());  // unorganised ones are filled up
      std::size_t same = 0;
      for (std::size_t k = 0; k < expected[i].size(); ++k) {
        const auto& a = found[i].points[k];
        const auto& b = expected[i].points[k];
        same += a == b || (a.hasNaN() && b.hasNaN()) ? 1 : 0;
      }
      EXPECT_EQ(same, expected[i].size());
    }
    EXPECT_TRUE(collected.warnings.empty());
  }

  fs::path dir_;
};

TEST_F(PacketLidar, RecordingsAreWhatTheirDecodersGive) {
  const OusterEncoder ouster;
  PacketLidarDevice device;
  device.metadata = Write("os0.json", ouster.Metadata());
  ExpectAsDecoded(device, Packets(ouster, 4),
                  PacketsByMetadata(ouster.Metadata(), "os0.json").get(), 4);

  const HesaiEncoder hesai;
  device.make = Make::kHesai;
  device.metadata = Write("angles.csv", hesai.Angles());
  ExpectAsDecoded(device, Packets(hesai, 3), PacketsByMetadata(hesai.Angles(), "angles.csv").get(),
                  3);

  const LivoxEncoder livox;
  device.make = Make::kLivox;
  device.metadata = "";
  const std::vector<Sent> sent = Packets(livox);
  ExpectAsDecoded(device, sent, LivoxPackets(sent.front().payload).get(), 1);

  const RobosenseEncoder robosense;
  device.make = Make::kRobosense;
  device.metadata = Write("angle.csv", robosense.Angles());
  ExpectAsDecoded(device, Packets(robosense, 3),
                  PacketsByMetadata(robosense.Angles(), "angle.csv").get(), 3);
}

TEST_F(PacketLidar, LivePacketsOfManyKilobytesBecomeSweeps) {
  const OusterEncoder encoder = LargeOuster();
  PacketLidarDevice device;
  device.metadata = Write("os0.json", encoder.Metadata());
  ASSERT_GT(encoder.Packet(0, 0).size(), 20'000U);
  PacketSource source(device);  // port 0: any
  DeviceThread thread([&](DeviceThread& self) { source.Serve(self); });
  for (int i = 0; i < 5000 && source.port() == 0; ++i) usleep(1000);
  ASSERT_NE(source.port(), 0);
  const UdpSender sender(source.port());
  const Utime start = HostUtime();
  for (const Sent& packet : Packets(encoder, 5)) {
    while (HostUtime() < start + packet.after_us) usleep(100);
    sender.Send(packet.payload);
  }
  Collected collected;
  ASSERT_TRUE(Collect(&thread, &collected, [&](const Collected& t) {
    // The fifth turn's end has not come.
    return Joined(t).size() == 4 && source.report().count("packets") == 10;
  }));
  const Cloud sweep = Joined(collected).back();
  EXPECT_EQ(sweep.lines, 128);
  EXPECT_EQ(sweep.beams, encoder.columns);
  EXPECT_EQ(source.report().count("packets"), 10);
  EXPECT_EQ(source.report().count("lost columns"), 0);
  EXPECT_GT(source.report().sweep_begun(), sweep.sweep_utime);
  EXPECT_THAT(source.report().GetStatus().text, HasSubstr("OS-0-4"));
}

TEST_F(PacketLidar, ARobosenseTellsItsAnglesOnAPortOfTheirOwn) {
  const RobosenseEncoder encoder{RobosenseEncoder::Model::kHelios};
  PacketLidarDevice device;
  device.make = Make::kRobosense;
  PacketSource source(device);  // port 0: any
  DeviceThread thread([&](DeviceThread& self) { source.Serve(self); });
  for (int i = 0; i < 5000 && source.port() == 0; ++i) usleep(1000);
  ASSERT_NE(source.port(), 0);
  UdpSender(7788).Send(encoder.Information());
  Collected collected;
  const UdpSender sender(source.port());
  const std::vector<Sent> sent = Packets(encoder, 3);
  const Utime start = HostUtime();
  for (const Sent& packet : sent) {
    while (HostUtime() < start + packet.after_us) usleep(100);
    sender.Send(packet.payload);
  }
  ASSERT_TRUE(Collect(&thread, &collected, [&](const Collected& t) {
    return Joined(t).size() == 3 &&
           source.report().count("packets") == static_cast<int>(sent.size());
  }));
  EXPECT_EQ(source.report().count("information packets"), 1);
  EXPECT_EQ(Joined(collected).back().lines, 32);
  EXPECT_EQ(source.report().count("lost columns"), 0);
  EXPECT_EQ(source.report().count("packets before angles"), 0);
  EXPECT_THAT(source.report().GetStatus().text, HasSubstr("RS-Helios-5515"));
}

// What comes, for a little more than the two seconds after which silence is told.
Collected Hear(PacketSource* source, const std::vector<Sent>& packets) {
  DeviceThread thread([&](DeviceThread& self) { source->Serve(self); });
  for (int i = 0; i < 5000 && source->port() == 0; ++i) usleep(1000);
  const UdpSender sender(source->port());
  Collected collected;
  const Utime begin = HostUtime();
  for (std::size_t i = 0; HostUtime() < begin + 2'400'000; ++i) {
    if (!packets.empty()) sender.Send(packets[i % packets.size()].payload);
    usleep(20'000);
    EXPECT_TRUE(Collect(&thread, &collected, [](const Collected&) { return true; }));
  }
  return collected;
}

TEST_F(PacketLidar, SilenceIsToldAndWhatIsNoSilenceIsNot) {
  OusterEncoder encoder;
  PacketLidarDevice device;
  device.metadata = Write("os0.json", encoder.Metadata());
  const auto silent = ": no packets for 2 s";
  EXPECT_TRUE(Hear(std::make_unique<PacketSource>(device).get(), {}).HasWarning(silent));
  const Collected its = Hear(std::make_unique<PacketSource>(device).get(), Packets(encoder, 8));
  EXPECT_FALSE(its.HasWarning(silent));
  EXPECT_FALSE(its.HasWarning("packets come"));
  encoder.profile = "RNG15_RFL8_NIR8";
  const Collected other = Hear(std::make_unique<PacketSource>(device).get(), Packets(encoder, 1));
  EXPECT_FALSE(other.HasWarning(silent));
  EXPECT_TRUE(other.HasWarning("but none with sweeps of a OS-0-4"));
}

// An Ouster whose metadata are of twice the columns, and whose clock is an hour behind.
TEST_F(PacketLidar, HalfATurnAndAClockThatIsOffAreTold) {
  OusterEncoder encoder;
  encoder.first_ns = (HostUtime() - 3600 * kMicrosecondsPerSecond) * 1000;
  std::vector<Sent> sent = Packets(encoder, 8);
  for (std::size_t i = sent.size(); i-- > 0;) {
    if (i % 2 == 1) sent.erase(sent.begin() + static_cast<std::ptrdiff_t>(i));
  }
  PacketLidarDevice device;
  device.metadata = Write("os0.json", encoder.Metadata());
  const Collected collected = Hear(std::make_unique<PacketSource>(device).get(), sent);
  EXPECT_TRUE(collected.HasWarning("half of its columns or more never came; is"));
  EXPECT_TRUE(collected.HasWarning("its clock is 3600"));
  EXPECT_TRUE(collected.HasWarning("s behind this machine's"));
}

TEST_F(PacketLidar, APacketOfAnotherSensorIsToldWithWhatToLookAt) {
  OusterEncoder encoder;
  PacketLidarDevice device;
  device.metadata = Write("os0.json", encoder.Metadata());
  encoder.profile = "RNG15_RFL8_NIR8";
  device.port = 7502;
  device.pcap = Record(7502, Packets(encoder, 1));
  PacketSource source(device);
  Collected collected;
  DeviceThread thread([&](DeviceThread& self) { source.Serve(self); });
  ASSERT_TRUE(Collect(&thread, &collected, [&](const Collected&) { return thread.ended(); }));
  EXPECT_EQ(source.report().count("other packets"), 2);
  EXPECT_TRUE(collected.HasWarning("none with sweeps of a OS-0-4"));
  EXPECT_TRUE(collected.HasWarning("os0.json of this very LIDAR, as it is set up now?"));
}

TEST_F(PacketLidar, MetadataThatIsMissingOrAnothersIsSaid) {
  PacketLidarDevice device;
  EXPECT_THAT([&] { PacketSource{device}; },
              ThrowsMessage<InputError>(HasSubstr("ouster needs metadata: \"FILE\"")));
  device.metadata = (dir_ / "nowhere.json").string();
  EXPECT_THAT([&] { PacketSource{device}; }, ThrowsMessage<InputError>(HasSubstr("nowhere.json")));
  device.metadata = Write("angles.csv", HesaiEncoder().Angles());
  EXPECT_THAT([&] { PacketSource{device}; },
              ThrowsMessage<InputError>(HasSubstr("angles.csv: describes no Ouster but a")));
  device.make = Make::kHesai;
  device.metadata = Write("os0.json", OusterEncoder().Metadata());
  EXPECT_THAT([&] { PacketSource{device}; },
              ThrowsMessage<InputError>(HasSubstr("os0.json: describes no Hesai but a OS-0-4")));
}

}  // namespace
}  // namespace rgbdt
