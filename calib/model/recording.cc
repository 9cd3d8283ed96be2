#include "calib/model/recording.h"

namespace rgbdt {

bool IsRecording(const LidarSpec& lidar) {
  if (const auto* velodyne = std::get_if<VelodyneDevice>(&lidar.device)) {
    return !velodyne->pcap.empty();
  }
  if (const auto* packets = std::get_if<PacketLidarDevice>(&lidar.device)) {
    return !packets->pcap.empty();
  }
  return std::holds_alternative<PcdFolderDevice>(lidar.device);
}

}  // namespace rgbdt
