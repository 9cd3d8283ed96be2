#include "services/drivers/packets/packet_source.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>

#include "calib/model/errors.h"
#include "services/drivers/lidar/lidar_node.h"
#include "services/drivers/packets/udp_port.h"
#include "services/posix/clock.h"
#include "tests/hardware/device_harness.h"
#include "tests/hardware/udp_sender.h"
#include "tests/hardware/velodyne_encoder.h"
#include "tests/numbers.h"

namespace rgbdt {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

VelodyneEncoder Encoder() { return MadeUpVelodyne(VelodyneEncoder::Model::kVlp16); }

// A folder of the test's own.
class Files : public ::testing::Test {
 protected:
  Files() {
    std::string name = (fs::temp_directory_path() / "rgbdt_velodyne_XXXXXX").string();
    dir_ = mkdtemp(name.data());
  }
  ~Files() override { fs::remove_all(dir_); }
  std::string Path(const std::string& name) const { return (dir_ / name).string(); }

  std::string Record(PcapWriter writer, const VelodyneEncoder& encoder, int packets) const {
    writer.Begin();
    for (int i = 0; i < packets; ++i) {
      writer.Add(kJune2015 + std::llround((i + 1) * encoder.PacketDuration_us()),
                 encoder.Packet(i));
      if (i % 10 == 0) writer.Add(kJune2015, std::vector<std::uint8_t>(554));  // a position packet
    }
    writer.Save(Path("recording.pcap"));
    return Path("recording.pcap");
  }

  fs::path dir_;
};

VelodyneDevice Device(const std::string& pcap) {
  VelodyneDevice device;
  device.pcap = pcap;
  return device;
}

// All that a recording gives; waits for its end.
Collected PlayAll(PacketSource* source) {
  Collected collected;
  DeviceThread thread([&](DeviceThread& self) { source->Serve(self); });
  EXPECT_TRUE(Collect(&thread, &collected, [&](const Collected&) { return thread.ended(); }));
  return collected;
}

using VelodyneRecording = Files;

TEST_F(VelodyneRecording, OfAnyKindIsPlayed) {
  const VelodyneEncoder encoder = Encoder();
  for (const bool next_generation : {false, true}) {
    for (const auto link : {PcapWriter::Link::kEthernet, PcapWriter::Link::kVlan,
                            PcapWriter::Link::kCooked, PcapWriter::Link::kRaw}) {
      PcapWriter writer;
      writer.link = link;
      writer.next_generation = next_generation;
      PacketSource source(Device(Record(writer, encoder, 160)));
      const Collected collected = PlayAll(&source);
      const auto chunks = collected.All<CloudChunk>();
      ASSERT_EQ(chunks.size(), 2u) << static_cast<int>(link) << next_generation;  // halves of one
      EXPECT_FALSE(chunks[0].sweep_end);
      EXPECT_TRUE(chunks[1].sweep_end);
      EXPECT_EQ(chunks[1].sweep_lines, 16);
      EXPECT_EQ(chunks[0].cloud.beams, 1800);
      // 90 degrees on, at 0.4 degrees a block.
      EXPECT_NEAR(static_cast<double>(chunks[0].cloud.sweep_utime - kJune2015), 225 * 110.592, 2);
      EXPECT_EQ(source.report().count("packets"), 160);
      EXPECT_EQ(source.report().count("bad packets"), 0);
      EXPECT_TRUE(collected.warnings.empty());
    }
  }
}

TEST_F(VelodyneRecording, BadFilesAreNamed) {
  const auto why = [&](const std::string& path) {
    try {
      PacketSource source(Device(path));
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string("opened");
  };
  EXPECT_THAT(why(Path("missing.pcap")), HasSubstr("missing.pcap"));
  EXPECT_THAT(why(dir_.string()), HasSubstr("is a folder"));
  PcapWriter writer;
  writer.Save(Path("empty.pcap"));
  EXPECT_THAT(why(Path("empty.pcap")), HasSubstr("empty.pcap"));
  writer.bytes = "this is no recording at all, whatever its name says";
  writer.Save(Path("text.pcap"));
  EXPECT_THAT(why(Path("text.pcap")), HasSubstr("text.pcap"));
}

TEST_F(VelodyneRecording, DamageInsideIsToldAndTheRestIsPlayed) {
  const VelodyneEncoder encoder = Encoder();
  PcapWriter writer;
  writer.Begin();
  for (int i = 0; i < 160; ++i) {
    const Utime utime = kJune2015 + std::llround((i + 1) * encoder.PacketDuration_us());
    auto packet = encoder.Packet(i);
    if (i == 50) packet.resize(700);
    if (i == 60) packet[0] = 1;
    writer.Add(utime, packet, i == 55 ? 300 : 100'000);
  }
  writer.bytes.resize(writer.bytes.size() - 100);
  writer.Save(Path("damaged.pcap"));
  PacketSource source(Device(Path("damaged.pcap")));
  const Collected collected = PlayAll(&source);
  EXPECT_EQ(collected.Count<CloudChunk>(), 2u);
  EXPECT_EQ(source.report().count("bad packets"), 2);
  EXPECT_EQ(source.report().count("other packets"), 1);  // of 700 bytes
  EXPECT_EQ(source.report().count("lost packets"), 3);
  EXPECT_TRUE(collected.HasWarning("cut short; record them whole"));
  EXPECT_TRUE(collected.HasWarning("damaged.pcap: is damaged or cut short"));
}

TEST_F(VelodyneRecording, OfAnotherPortSaysSo) {
  PcapWriter writer;
  writer.port = 2369;
  PacketSource source(Device(Record(writer, Encoder(), 3)));
  EXPECT_TRUE(PlayAll(&source).HasWarning("no packets to UDP port 2368, but"));
}

using VelodyneNode = Files;

TEST_F(VelodyneNode, ASweepCommandIsDoneWithTheFirstWholeOneAfterIt) {
  LidarSpec lidar;
  lidar.device = Device(Record({}, Encoder(), 6 * 75));
  LidarNode node(lidar);
  Collected collected;
  ASSERT_TRUE(
      Collect(&node, &collected, [](const Collected& t) { return t.Count<CloudChunk>() >= 1; }));
  const Utime newest = collected.All<CloudChunk>().back().cloud.sweep_utime;
  SessionCommand command;
  command.verb = SessionVerb::kSweep;
  command.command = 7;
  EXPECT_TRUE(node.Handle(command).empty());
  ASSERT_TRUE(
      Collect(&node, &collected, [](const Collected& t) { return t.Count<SessionEvent>() == 1; }));
  const SessionEvent event = collected.All<SessionEvent>()[0];
  EXPECT_EQ(event.command, 7);
  EXPECT_EQ(event.kind, EventKind::kDone);
  EXPECT_GT(event.sweep_utime, newest + 90'000);  // not the one that had begun
  // Its chunks came before.
  EXPECT_EQ(collected.All<CloudChunk>().back().cloud.sweep_utime, event.sweep_utime);
  EXPECT_TRUE(node.GetStatus().ready);
  // No sweep begins any more.
  command.command = 8;
  ASSERT_TRUE(Collect(&node, &collected, [&](const Collected&) { return node.finished(); }));
  node.Handle(command);
  ASSERT_TRUE(
      Collect(&node, &collected, [](const Collected& t) { return t.Count<SessionEvent>() == 2; }));
  EXPECT_EQ(collected.All<SessionEvent>()[1].kind, EventKind::kFailed);
}

TEST_F(VelodyneNode, WithoutADeviceSaysWhatToAdd) {
  try {
    LidarNode node(LidarSpec{});
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("velodyne { model: VLP16 }"));
  }
}

TEST(VelodyneLive, APortIsListenedAt) {
  VelodyneDevice device;
  device.port = 0;
  PacketSource source(device);
  DeviceThread thread([&](DeviceThread& self) { source.Serve(self); });
  for (int i = 0; i < 5000 && source.port() == 0; ++i) usleep(1000);
  ASSERT_NE(source.port(), 0);
  const UdpSender sender(source.port());
  const VelodyneEncoder encoder = Encoder();
  const Utime start = HostUtime();
  for (int i = 0; i < 160; ++i) {
    const Utime due = start + std::llround((i + 1) * encoder.PacketDuration_us());
    while (HostUtime() < due) usleep(200);
    sender.Send(encoder.Packet(i));
    if (i == 20) sender.Send(std::vector<std::uint8_t>(554));
    if (i == 30) sender.Send({1, 2, 3});
  }
  Collected collected;
  ASSERT_TRUE(Collect(&thread, &collected, [&](const Collected& t) {
    return t.Count<CloudChunk>() == 2 && source.report().count("packets") == 160;
  }));
  const auto chunk = collected.All<CloudChunk>()[1];
  EXPECT_TRUE(chunk.sweep_end);
  const double late = static_cast<double>(chunk.cloud.sweep_utime - start) - 225 * 110.592;
  RecordProperty("late_us", std::to_string(late));
  EXPECT_GT(late, -10);
  EXPECT_LT(late, 20'000);  // the least delay of 160 packets on a busy machine
  EXPECT_EQ(source.report().count("bad packets"), 0);
  EXPECT_EQ(source.report().count("other packets"), 2);
}

TEST(VelodyneLive, APortInUseSaysSo) {
  const UdpPort taken(0);
  VelodyneDevice device;
  device.port = taken.port();
  PacketSource source(device);
  DeviceThread thread([&](DeviceThread& self) { source.Serve(self); });
  Collected collected;
  ASSERT_TRUE(Collect(&thread, &collected, [](const Collected& t) { return !t.warnings.empty(); }));
  EXPECT_THAT(collected.warnings[0], HasSubstr("is in use"));
}

}  // namespace
}  // namespace rgbdt
