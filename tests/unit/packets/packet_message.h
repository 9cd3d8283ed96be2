#pragma once

// Packets of a LIDAR as drivers of ROS put them into messages.

#include <cstdint>
#include <string>
#include <vector>

#include "calib/model/time.h"
#include "tests/unit/import/ros_bytes.h"

namespace rgbdt::test {

/// A packet, and when it was.
struct Sent {
  Utime utime;
  std::vector<std::uint8_t> bytes;
};

/// A message of this type that holds these packets.
inline std::string PacketMessage(const std::string& type, BagEncoding encoding, const Sent* first,
                                 const Sent* last, bool frame_header) {
  const auto text = [](const Sent& sent) {
    return std::string(sent.bytes.begin(), sent.bytes.end());
  };
  RosBytes m(encoding);
  if (type.find("PacketMsg") != std::string::npos) return m.Blob(text(*first)).Bytes();
  if (type != "hesai_ros_driver/UdpFrame" || frame_header) {
    m.Header(static_cast<std::uint32_t>(first->utime / 1'000'000), 0, "lidar");
  }
  if (type == "rslidar_msg/RslidarPacket") {
    for (const std::uint8_t flag : {0, 1}) m.Add(flag);  // of information; begins a sweep
    return m.Blob(text(*first)).Bytes();
  }
  m.Add(static_cast<std::uint32_t>(last - first));
  for (const Sent* sent = first; sent != last; ++sent) {
    m.Add(static_cast<std::uint32_t>(sent->utime / 1'000'000));
    m.Add(static_cast<std::uint32_t>(sent->utime % 1'000'000 * 1000));
    std::string bytes = text(*sent);
    const auto size = static_cast<std::uint32_t>(bytes.size());
    const bool padded = type == "pandar_msgs/PandarScan",
               fixed = type == "velodyne_msgs/VelodyneScan" ||
                       type == "robosense_msgs/RobosenseScan" || type == "rslidar_msgs/rslidarScan";
    if (padded) bytes.resize(1500);
    if (padded || fixed) {
      for (const char c : bytes) m.Add(c);
    } else {
      m.Blob(bytes);
    }
    if (padded || type == "hesai_ros_driver/UdpFrame") m.Add(size);
  }
  return m.Bytes();
}

}  // namespace rgbdt::test
