#include "tests/fuzz/seeds/seeds.h"
#include "tests/hardware/velodyne_encoder.h"
#include "tests/unit/packets/hesai_encoder.h"
#include "tests/unit/packets/ouster_encoder.h"
#include "tests/unit/packets/packet_message.h"
#include "tests/unit/packets/robosense_encoder.h"

namespace rgbdt::fuzz {
namespace {

using Inputs = std::map<std::string, std::string>;
using Payloads = std::vector<std::vector<std::uint8_t>>;
using test::HesaiEncoder;
using test::OusterEncoder;
using test::RobosenseEncoder;

// Before each packet a word of the time since the one before [64 us].
std::string InLine(const Payloads& packets) {
  std::string bytes;
  for (const auto& packet : packets) {
    bytes += std::string("\0\x10", 2) + std::string(packet.begin(), packet.end());
  }
  return bytes;
}

Payloads OusterTurns(const OusterEncoder& encoder, int packets) {
  const int in_turn = encoder.columns / encoder.columns_per_packet;
  Payloads all;
  for (int i = 0; i < packets; ++i) all.push_back(encoder.Packet(i / in_turn, i % in_turn));
  return all;
}

OusterEncoder SmallOuster() {
  OusterEncoder small;
  small.rows = 2;
  small.columns = 8;
  small.columns_per_packet = 4;
  small.shifts = {1, -1};
  small.altitude_deg = {5, -5};
  small.azimuth_deg = {3, -3};
  return small;
}

void AddOuster(Inputs* seeds) {
  char kind = 0;
  for (const char* profile :
       {"LEGACY", "RNG19_RFL8_SIG16_NIR16", "RNG19_RFL8_SIG16_NIR16_DUAL", "RNG15_RFL8_NIR8"}) {
    const std::string name = profile;
    OusterEncoder encoder;
    encoder.profile = profile;
    (*seeds)[name] = std::string(1, kind) + InLine(OusterTurns(encoder, 4));
    (*seeds)[name + "_mended"] =
        static_cast<char>(kind | 4) + InLine(OusterTurns(encoder, 3)) + "cut short";
    OusterEncoder small = SmallOuster();
    small.profile = profile;
    small.nested = true;
    // On a clock that shows the time.
    small.first_ns = 1'700'000'000'000'000'000;
    const std::string metadata = Piece(small.Metadata());
    (*seeds)[name + "_own"] =
        static_cast<char>(kind | 8) + metadata + InLine(OusterTurns(small, 5));
    (*seeds)[name + "_own_mended"] =
        static_cast<char>(kind | 12) + metadata + InLine(OusterTurns(small, 3));
    ++kind;
  }
  const std::string own = "\x08";
  std::string flat = SmallOuster().Metadata();
  (*seeds)["flat"] = own + Piece(flat) + InLine(OusterTurns(SmallOuster(), 3));
  const std::string key = "\"lidar_origin_to_beam_origin_mm\":15.8";
  flat.replace(flat.find(key), key.size(),
               "\"beam_to_lidar_transform\":[1,0,0,15.8,0,1,0,0,0,0,1,2,0,0,0,1]");
  (*seeds)["transform"] = own + Piece(flat);
  (*seeds)["profile"] = own + Piece(R"({"lidar_data_format":{"udp_profile_lidar":"OFF"}})");
  (*seeds)["missing"] = own + Piece(R"({"data_format":{"columns_per_frame":-1}})");
  (*seeds)["array"] = own + Piece("[[[[]]]]");
}

// A turn's begin and a few packets of it, half a turn apart at most, then the next one's.
Payloads HesaiTurns(const HesaiEncoder& encoder) {
  Payloads all;
  int us = 0;
  for (const int azimuth : {17600, 26000, 34000, 6000, 14000, 17600, 26000, 34000}) {
    all.push_back(encoder.Packet(azimuth, us));
    us += 4200;
  }
  return all;
}

void AddHesai(Inputs* seeds) {
  char kind = 0;
  for (const HesaiEncoder::Model model : HesaiEncoder::kAll) {
    HesaiEncoder encoder{model};
    const std::string name = std::to_string(kind);
    (*seeds)[name] = std::string(1, kind) + InLine(HesaiTurns(encoder));
    (*seeds)[name + "_one"] = std::string(1, kind) + InLine({encoder.Packet(0, 7)});
    (*seeds)[name + "_mended"] = static_cast<char>(kind | 0x10) + InLine(HesaiTurns(encoder));
    (*seeds)[name + "_own"] = static_cast<char>(kind | 0x20) + Piece(encoder.Angles()) +
                              InLine({encoder.Packet(17900, 0), encoder.Packet(18700, 400)});
    encoder.high_resolution = true;
    encoder.near = 100;
    (*seeds)[name + "_fine"] = std::string(1, kind) + InLine(HesaiTurns(encoder));
    encoder.has_date = false;
    encoder.dual = true;
    (*seeds)[name + "_dual"] = std::string(1, kind) + InLine(HesaiTurns(encoder));
    ++kind;
  }
  const std::string own = "\x20";
  (*seeds)["twice"] = own + Piece("1,2,3\n1,2,3\n");
  (*seeds)["missing"] = own + Piece("Channel,Elevation,Azimuth\r\n1,2,3\n3,1,3\n");
  (*seeds)["large"] = own + Piece("4000000000,2,3\n");
  (*seeds)["sum"] = own + Piece("1,2,3\n" + std::string(64, '7'));
  (*seeds)["none"] = own + Piece("");
}

// Half a turn apart at most, as above.
Payloads RobosenseTurns(const RobosenseEncoder& encoder) {
  Payloads all = {encoder.Information()};
  int us = 0;
  for (const int azimuth : {17600, 26000, 34000, 6000, 14000, 17600, 26000, 34000}) {
    all.push_back(encoder.Packet(azimuth, us));
    us += 4200;
  }
  return all;
}

void AddRobosense(Inputs* seeds) {
  char kind = 0;
  for (const RobosenseEncoder::Model model : RobosenseEncoder::kAll) {
    RobosenseEncoder encoder{model};
    const std::string name = std::to_string(kind);
    (*seeds)[name] = std::string(1, kind) + InLine(RobosenseTurns(encoder));
    (*seeds)[name + "_mended"] = static_cast<char>(kind | 0x08) + InLine(RobosenseTurns(encoder));
    (*seeds)[name + "_own"] =
        static_cast<char>(kind | 0x10) + Piece(encoder.Angles()) + InLine(RobosenseTurns(encoder));
    (*seeds)[name + "_told"] = static_cast<char>(kind | 0x20) + InLine(RobosenseTurns(encoder));
    encoder.has_date = false;
    encoder.dual = true;
    (*seeds)[name + "_dual"] = static_cast<char>(kind | 0x20) + InLine(RobosenseTurns(encoder));
    ++kind;
  }
  const std::string own = "\x10";
  (*seeds)["steep"] = own + Piece("1,2\n100,2\n");
  (*seeds)["none"] = own + Piece("");
}

std::string Recorded(const Payloads& packets, bool another_sender = false) {
  PcapWriter writer;
  writer.Begin();
  std::int64_t utime = 1'700'000'000'000'000;
  for (const auto& packet : packets) {
    writer.from[3] = 201;
    writer.Add(utime += 1600, packet);
    if (!another_sender) continue;
    writer.from[3] = 202;
    writer.Add(utime += 10, {1, 2, 3});
  }
  return writer.bytes;
}

void AddRecordings(Inputs* seeds) {
  VelodyneEncoder velodyne = MadeUpVelodyne(VelodyneEncoder::Model::kVlp16);
  velodyne.block_turn = 2900;  // so fast that a revolution takes few packets
  Payloads packets;
  for (int i = 0; i < 5; ++i) packets.push_back(velodyne.Packet(i));
  const std::string none(1, '\0');
  (*seeds)["velodyne"] = none + Recorded(packets);
  (*seeds)["two"] = none + Recorded({packets[0], packets[1]}, true);
  (*seeds)["cut"] = none + Recorded({packets[0]}).substr(0, 700);
  (*seeds)["ouster"] = "\x01" + Recorded(OusterTurns(OusterEncoder(), 3));
  (*seeds)["hesai"] = "\x02" + Recorded(HesaiTurns(HesaiEncoder()));
  OusterEncoder small = SmallOuster();
  (*seeds)["own"] = "\x03" + Piece(small.Metadata()) + Recorded(OusterTurns(small, 5));
  const HesaiEncoder hesai{HesaiEncoder::Model::kXt32};
  (*seeds)["own_angles"] = "\x03" + Piece(hesai.Angles()) + Recorded({hesai.Packet(0, 0)});
  (*seeds)["unknown"] = "\x03" + Piece(HesaiEncoder::Angles(7)) + Recorded({packets[0]});
}

// As bag_packets.cc takes them: whose metadata, of which type, and packets.
std::string InBag(int kind, int type, const std::string& metadata, const Payloads& packets) {
  std::string bytes = {static_cast<char>(kind), static_cast<char>(type)};
  if (kind % 4 == 3) bytes += Piece(metadata);
  for (const auto& packet : packets) bytes += Piece({packet.begin(), packet.end()});
  return bytes;
}

void AddBagPackets(Inputs* seeds) {
  constexpr int kRos2 = 0x10, kWholeMessages = 0x20;
  constexpr int kVelodyne = 0, kPandar = 1, kNebula = 2, kUdpFrame = 3, kOuster = 4, kRslidar = 5;
  VelodyneEncoder velodyne = MadeUpVelodyne(VelodyneEncoder::Model::kVlp16);
  velodyne.block_turn = 2900;
  Payloads packets;
  for (int i = 0; i < 40; ++i) packets.push_back(velodyne.Packet(i));
  (*seeds)["velodyne"] = InBag(0, kVelodyne, "", packets);
  packets.resize(8);
  (*seeds)["velodyne_ros2"] = InBag(kRos2, kVelodyne, "", packets);
  (*seeds)["nebula"] = InBag(kRos2, kNebula, "", packets);
  std::vector<test::Sent> sent;
  for (const auto& packet : packets) sent.push_back({1'700'000'000'000'000, packet});
  const std::string message = test::PacketMessage("velodyne_msgs/VelodyneScan", BagEncoding::kRos1,
                                                  sent.data(), sent.data() + sent.size(), false);
  (*seeds)["message"] =
      InBag(kWholeMessages, kVelodyne, "", {{message.begin(), message.end()}, {1, 2, 3}, {}});
  (*seeds)["ouster"] = InBag(1, kOuster, "", OusterTurns(OusterEncoder(), 3));
  (*seeds)["ouster_own"] =
      InBag(kRos2 | 3, kOuster, SmallOuster().Metadata(), OusterTurns(SmallOuster(), 9));
  (*seeds)["hesai"] = InBag(2, kPandar, "", HesaiTurns(HesaiEncoder()));
  (*seeds)["robosense"] =
      InBag(kRos2, kRslidar, "", RobosenseTurns({RobosenseEncoder::Model::kHelios}));
  const HesaiEncoder hesai{HesaiEncoder::Model::kXt32};
  (*seeds)["hesai_own"] = InBag(3, kUdpFrame, hesai.Angles(), HesaiTurns(hesai));
  (*seeds)["whose"] = InBag(0, kNebula, "", {{1, 2, 3}, packets[0], {4}});
  (*seeds)["none"] = InBag(1, kOuster, "", {});
}

}  // namespace

void AddPacketSeeds(Seeds* seeds) {
  AddOuster(&(*seeds)["ouster"]);
  AddHesai(&(*seeds)["hesai"]);
  AddRobosense(&(*seeds)["robosense"]);
  AddRecordings(&(*seeds)["recording"]);
  AddBagPackets(&(*seeds)["bag_packets"]);
}

}  // namespace rgbdt::fuzz
