// A LIDAR's packets in a bag, as `rgbdt import` reads them. The first byte: whose metadata are
// given (none, an Ouster's, a Hesai's, or what comes next in the input), whether the driver is of
// ROS 2, and whether the pieces that follow are packets, which are put into messages, or whole
// messages. The second: of which type these are.
#include "services/packets/bag_packets.h"

#include <iterator>

#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/sweep_check.h"
#include "tests/unit/bags/bag_bytes.h"
#include "tests/unit/packets/hesai_encoder.h"
#include "tests/unit/packets/ouster_encoder.h"
#include "tests/unit/packets/packet_message.h"

namespace rgbdt {
namespace {

constexpr unsigned kRos2 = 0x10, kWholeMessages = 0x20;
constexpr const char* kTopic = "/lidar/packets";
constexpr const char* kTypes[] = {"velodyne_msgs/VelodyneScan",  "pandar_msgs/PandarScan",
                                  "nebula_msgs/NebulaPackets",   "hesai_ros_driver/UdpFrame",
                                  "ouster_ros/PacketMsg",        "rslidar_msg/RslidarPacket",
                                  "robosense_msgs/RobosenseScan"};

// One topic, what is left of the input as its messages.
std::string BagOf(unsigned kind, const std::string& type, fuzz::Input* input) {
  using test::Little;
  using test::Text;
  const bool ros2 = (kind & kRos2) != 0;
  const std::size_t slash = type.find('/');
  const std::string name = ros2 ? type.substr(0, slash) + "/msg" + type.substr(slash) : type;
  const std::string schema = Text(name) + Text(ros2 ? "ros2msg" : "ros1msg") + Text("");
  const std::string channel = Text(kTopic) + Text(ros2 ? "cdr" : "ros1") + Little(std::uint32_t{0});
  std::string bag = test::kMcapMagic + test::McapRecord(3, Little(std::uint16_t{1}) + schema) +
                    test::McapRecord(4, Little(std::uint32_t{0x10001}) + channel);
  Utime utime = 1'700'000'000'000'000;
  while (!input->empty()) {
    std::string piece = input->Piece();
    utime += 1000;
    if ((kind & kWholeMessages) == 0) {
      const test::Sent sent{utime, {piece.begin(), piece.end()}};
      piece = test::PacketMessage(type, ros2 ? BagEncoding::kCdr : BagEncoding::kRos1, &sent,
                                  &sent + 1, false);
    }
    bag += test::McapMessage(1, static_cast<std::uint64_t>(utime) * 1000, piece);
  }
  return bag;
}

void ReadSweeps(BagPackets* packets) {
  constexpr std::size_t kMost = 8;
  const std::vector<Stamped> found = packets->Find(
      [](double share) { fuzz::Require(share >= 0 && share <= 1, "a share of the bag"); });
  fuzz::Require(!found.empty() && !packets->lines().empty(), "sweeps, and what they are of");
  for (const std::string& line : packets->lines()) {
    fuzz::Require(line.find('\n') == std::string::npos, "one line; it says: " + line);
  }
  for (std::size_t i = 0; i < found.size() && i < kMost; ++i) {
    const Cloud sweep = packets->Read(found[i]);
    fuzz::RequireWhole(sweep);
    fuzz::Require(sweep.sweep_utime == found[i].utime, "the sweep that was found");
  }
  fuzz::RequireWhole(packets->Read(found.front()));  // back again
}

void TakeInput(const std::uint8_t* data, std::size_t size) {
  static const fuzz::ScratchFile file("packets.mcap");
  static const std::string ouster = test::OusterEncoder().Metadata();
  static const std::string hesai = test::HesaiEncoder().Angles();
  fuzz::Input input(data, size);
  const unsigned kind = input.Byte();
  const std::string type = kTypes[input.Byte() % std::size(kTypes)];
  BagPacketsOptions options{kTopic, "", "metadata"};
  switch (kind % 4) {
    case 1:
      options.metadata = ouster;
      break;
    case 2:
      options.metadata = hesai;
      break;
    case 3:
      options.metadata = input.Piece();
      break;
    default:
      break;
  }
  file.Write(BagOf(kind, type, &input));
  fuzz::Try([&] {
    BagPackets packets(file.path(), options);
    ReadSweeps(&packets);
  });
}

}  // namespace
}  // namespace rgbdt

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  rgbdt::TakeInput(data, size);
  return 0;
}
