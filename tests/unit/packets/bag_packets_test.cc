// The same packets in a bag and in a recording (pcap) give the same sweeps, bit for bit.
#include "services/packets/bag_packets.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calib/files/atomic_file.h"
#include "calib/model/errors.h"
#include "services/bags/mcap_writer.h"
#include "services/import/topics.h"
#include "services/packets/recording.h"
#include "tests/hardware/velodyne_encoder.h"
#include "tests/unit/files/test_data.h"
#include "tests/unit/import/ros_bytes.h"
#include "tests/unit/packets/hesai_encoder.h"
#include "tests/unit/packets/livox_encoder.h"
#include "tests/unit/packets/ouster_encoder.h"
#include "tests/unit/packets/packet_message.h"
#include "tests/unit/packets/robosense_encoder.h"

namespace rgbdt {
namespace {

using test::PacketMessage;
using test::RosBytes;
using test::Sent;
using testing::HasSubstr;
using testing::SizeIs;

constexpr Utime kBegin = 1'700'000'000'000'000;

class BagPacketsTest : public testing::Test {
 protected:
  // Both; the bag with `together` packets a message and other topics between.
  void Record(const std::string& type, BagEncoding encoding, const std::vector<Sent>& sent,
              std::size_t together, bool frame_header = false) {
    PcapWriter pcap;
    pcap.Begin();
    for (const Sent& one : sent) pcap.Add(one.utime, one.bytes);
    pcap.Save(pcap_.string());
    std::string bytes;
    McapWriter bag([&](std::string_view more) { bytes += more; }, "test");
    const bool cdr = encoding == BagEncoding::kCdr;
    const std::size_t slash = type.find('/');
    const std::string ros2 = type.substr(0, slash) + "/msg" + type.substr(slash);
    const auto schema = bag.AddSchema(cdr ? ros2 : type, cdr ? "ros2msg" : "ros1msg", "");
    const auto text = bag.AddSchema(cdr ? "std_msgs/msg/String" : "std_msgs/String",
                                    cdr ? "ros2msg" : "ros1msg", "");
    const std::string as = cdr ? "cdr" : "ros1";
    const auto packets = bag.AddChannel("/lidar/packets", schema, as);
    const auto imu = bag.AddChannel("/lidar/imu_packets", schema, as);
    const auto told = bag.AddChannel("/lidar/metadata", text, as);
    const bool has_imu = type.find("PacketMsg") != std::string::npos;
    for (std::size_t i = 0; i < sent.size(); i += together) {
      const std::size_t end = std::min(sent.size(), i + together);
      const Sent *first = sent.data() + i, *last = sent.data() + end;
      bag.Write(packets, first->utime, first->utime,
                PacketMessage(type, encoding, first, last, frame_header));
      if (!has_imu || i % 5 != 0) continue;
      const Sent small{first->utime, std::vector<std::uint8_t>(48, 1)};
      bag.Write(imu, first->utime, first->utime,
                PacketMessage(type, encoding, &small, &small + 1, false));
    }
    if (!metadata_.empty()) {
      bag.Write(told, kBegin, kBegin, RosBytes(encoding).Text(metadata_).Bytes());
    }
    bag.Finish();
    WriteFileAtomically(bag_, bytes);
  }

  std::vector<Cloud> FromPcap() {
    std::vector<Cloud> sweeps;
    RecordingOptions options;
    if (!metadata_.empty()) {
      WriteFileAtomically(dir_ / "metadata", metadata_);
      options.metadata = dir_ / "metadata";
    }
    ReadRecording(pcap_, options, [&](const Cloud& sweep) { sweeps.push_back(sweep); });
    return sweeps;
  }

  // As `rgbdt import` finds them.
  BagPacketsOptions Options() {
    const auto bag = OpenBag(bag_);
    const BagSurvey survey = SurveyBag(bag.get(), nullptr);
    const BagSurvey::Topic* topic = survey.Find("/lidar/packets");
    EXPECT_NE(topic, nullptr);
    EXPECT_EQ(topic->data, BagData::kPackets) << topic->problem;
    const BagSurvey::Topic* imu = survey.Find("/lidar/imu_packets");
    EXPECT_TRUE(imu == nullptr || imu->what.empty() || imu->data == BagData::kOther);
    const BagSurvey::Topic* told = MetadataOf(survey, *topic);
    BagPacketsOptions options{"/lidar/packets", told == nullptr ? "" : told->text,
                              "/lidar/metadata"};
    EXPECT_EQ(options.metadata, metadata_);
    return options;
  }

  void ExpectSame() {
    const std::vector<Cloud> expected = FromPcap();
    ASSERT_GE(expected.size(), 2U);
    BagPackets packets(bag_, Options());
    const std::vector<Stamped> found = packets.Find(nullptr);
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_EQ(found[i].utime, expected[i].sweep_utime);
      ExpectEqual(packets.Read(found[i]), expected[i]);
    }
    ExpectEqual(packets.Read(found.front()), expected.front());  // back again
  }

  template <typename T>
  static void ExpectSameBytes(const std::vector<T>& a, const std::vector<T>& b) {
    ASSERT_EQ(a.size(), b.size());
    if (a.empty()) return;  // memcmp takes no null
    EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(T)), 0);
  }
  static void ExpectEqual(const Cloud& a, const Cloud& b) {
    EXPECT_EQ(a.sweep_utime, b.sweep_utime);
    EXPECT_EQ(a.lines, b.lines);
    EXPECT_EQ(a.beams, b.beams);
    EXPECT_EQ(a.organised, b.organised);
    ExpectSameBytes(a.points, b.points);
    ExpectSameBytes(a.directions, b.directions);
    ExpectSameBytes(a.origins, b.origins);
    ExpectSameBytes(a.intensity, b.intensity);
    ExpectSameBytes(a.utime, b.utime);
    ExpectSameBytes(a.ring, b.ring);
  }

  test::TempDir dir_;
  std::filesystem::path pcap_ = dir_ / "x.pcap", bag_ = dir_ / "x.mcap";
  std::string metadata_;
};

std::vector<Sent> VelodynePackets(VelodyneEncoder::Model model, int turns) {
  const VelodyneEncoder encoder = MadeUpVelodyne(model);
  std::vector<Sent> sent;
  for (int i = 0; i < turns * encoder.PacketsPerTurn(); ++i) {
    sent.push_back(
        {kBegin + static_cast<Utime>(i * encoder.PacketDuration_us()), encoder.Packet(i)});
  }
  return sent;
}

TEST_F(BagPacketsTest, AVelodynesAreTheSameInEitherRos) {
  for (const BagEncoding encoding : {BagEncoding::kRos1, BagEncoding::kCdr}) {
    for (const auto model : {VelodyneEncoder::Model::kVlp16, VelodyneEncoder::Model::kVlp32c}) {
      Record("velodyne_msgs/VelodyneScan", encoding, VelodynePackets(model, 4), 76);
      ExpectSame();
    }
    Record("nebula_msgs/NebulaPackets", encoding,
           VelodynePackets(VelodyneEncoder::Model::kVlp16, 4), 50);
    ExpectSame();
  }
}

TEST_F(BagPacketsTest, AnOustersAreTheSameByTheBagsMetadata) {
  test::OusterEncoder encoder;
  metadata_ = encoder.Metadata();
  std::vector<Sent> sent;
  const int in_turn = encoder.columns / encoder.columns_per_packet;
  for (int i = 0; i < 8; ++i) {
    sent.push_back({kBegin + 1600 * i, encoder.Packet(i / in_turn, i % in_turn)});
  }
  for (const BagEncoding encoding : {BagEncoding::kRos1, BagEncoding::kCdr}) {
    for (const char* type : {"ouster_ros/PacketMsg", "ouster_sensor_msgs/PacketMsg"}) {
      Record(type, encoding, sent, 1);
      ExpectSame();
    }
  }
}

TEST_F(BagPacketsTest, AHesaisAreTheSameByItsAngles) {
  const test::HesaiEncoder encoder{test::HesaiEncoder::Model::kXt32};
  metadata_ = encoder.Angles();
  std::vector<Sent> sent;
  for (int i = 0; i < 3 * 360 / encoder.blocks() + 10; ++i) {
    const int us = 50 * encoder.blocks() * i;
    sent.push_back(
        {test::HesaiEncoder::kSecond + us, encoder.Packet(100 * encoder.blocks() * i % 36000, us)});
  }
  for (const BagEncoding encoding : {BagEncoding::kRos1, BagEncoding::kCdr}) {
    for (const char* type :
         {"pandar_msgs/PandarScan", "nebula_msgs/NebulaPackets", "hesai_ros_driver/UdpFrame"}) {
      Record(type, encoding, sent, 45);
      ExpectSame();
    }
    Record("hesai_ros_driver/UdpFrame", encoding, sent, 45, true);
    ExpectSame();
  }
}

TEST_F(BagPacketsTest, ALivoxsAreTheSame) {
  std::vector<Sent> sent;
  test::LivoxEncoder encoder;
  for (int i = 0; i < 2 * encoder.PacketsPerSecond() + 5; ++i) {
    sent.push_back({kBegin + i * encoder.period_us(), encoder.Packet(i)});
  }
  Record("nebula_msgs/NebulaPackets", BagEncoding::kCdr, sent, 100);
  ExpectSame();
}

TEST_F(BagPacketsTest, ARobosensesAreTheSameByItsAnglesAndByItsPackets) {
  const test::RobosenseEncoder encoder{test::RobosenseEncoder::Model::kHelios};
  std::vector<Sent> sent;
  for (int i = 0; i < 3 * 30 + 10; ++i) {
    const int us = static_cast<int>(encoder.packet_us() * i);
    sent.push_back({test::RobosenseEncoder::kSecond + us, encoder.Packet(1200 * i % 36000, us)});
  }
  for (const std::string& angles : {encoder.Angles(), std::string()}) {
    metadata_ = angles;
    if (angles.empty()) {
      sent.insert(sent.begin(), {test::RobosenseEncoder::kSecond - 5, encoder.Information()});
    }
    for (const BagEncoding encoding : {BagEncoding::kRos1, BagEncoding::kCdr}) {
      Record("rslidar_msg/RslidarPacket", encoding, sent, 1);
      ExpectSame();
      for (const char* type : {"robosense_msgs/RobosenseScan", "rslidar_msgs/rslidarScan"}) {
        Record(type, encoding, sent, 20);
        ExpectSame();
      }
    }
  }
}

TEST_F(BagPacketsTest, WhatIsWrongIsSaid) {
  test::OusterEncoder encoder;
  Record("ouster_ros/PacketMsg", BagEncoding::kRos1, {{kBegin, encoder.Packet(0, 0)}}, 1);
  const auto why = [&](const BagPacketsOptions& options) {
    return test::ErrorOf([&] { BagPackets(bag_, options).Find(nullptr); });
  };
  EXPECT_THAT(why({"/lidar/packets", "", ""}), HasSubstr("give --metadata"));
  EXPECT_THAT(why({"/lidar/packets", "{", "os.json"}), HasSubstr("os.json"));
  EXPECT_THAT(why({"/lidar/packets", encoder.Metadata(), "os.json"}), HasSubstr("no whole sweep"));
  // Damaged messages are told; the others are taken.
  const auto sent = VelodynePackets(VelodyneEncoder::Model::kVlp16, 4);
  Record("velodyne_msgs/VelodyneScan", BagEncoding::kRos1, sent, 76);
  std::string bytes = ReadWholeFile(bag_);
  BagPackets packets(bag_, {"/lidar/packets", "", ""});
  packets.Find(nullptr);
  EXPECT_THAT(packets.lines(), SizeIs(1));
  EXPECT_THAT(packets.lines()[0], HasSubstr("packets of a VLP-16, "));
}

TEST(PacketMessages, CutShortOrTooLongTheyAreRefused) {
  const Sent one{kBegin, std::vector<std::uint8_t>(700, 3)};
  for (const BagEncoding encoding : {BagEncoding::kRos1, BagEncoding::kCdr}) {
    for (const char* type :
         {"velodyne_msgs/VelodyneScan", "pandar_msgs/PandarScan", "nebula_msgs/NebulaPackets",
          "hesai_ros_driver/UdpFrame", "ouster_ros/PacketMsg", "robosense_msgs/RobosenseScan",
          "rslidar_msg/RslidarPacket"}) {
      Sent sent = one;
      if (std::string(type) == "robosense_msgs/RobosenseScan") sent.bytes.resize(1248);
      if (std::string(type) == "velodyne_msgs/VelodyneScan") sent.bytes.resize(1206);
      const std::string whole = PacketMessage(type, encoding, &sent, &sent + 1, false);
      const BagTopic topic{"/x", type, encoding};
      const ros::Packets packets = ros::DecodePackets(test::MessageOf(whole), topic);
      ASSERT_THAT(packets.packets, SizeIs(1)) << type;
      EXPECT_EQ(packets.packets[0].size, sent.bytes.size());
      for (std::size_t size = 0; size < whole.size(); size += 7) {
        const std::string cut = whole.substr(0, size);
        EXPECT_THROW(ros::DecodePackets(test::MessageOf(cut), topic), InputError) << type << size;
      }
      const std::string longer = whole + "x";
      EXPECT_THROW(ros::DecodePackets(test::MessageOf(longer), topic), InputError);
    }
  }
}

}  // namespace
}  // namespace rgbdt
