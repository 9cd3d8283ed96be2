#include "calib/model/recording.h"

#include <gtest/gtest.h>

namespace rgbdt {
namespace {

TEST(IsRecording, FilesAreAndDevicesAreNot) {
  LidarSpec lidar;
  EXPECT_FALSE(IsRecording(lidar));
  lidar.device = HokuyoDevice();
  EXPECT_FALSE(IsRecording(lidar));
  VelodyneDevice velodyne;
  lidar.device = velodyne;
  EXPECT_FALSE(IsRecording(lidar));
  velodyne.pcap = "a.pcap";
  lidar.device = velodyne;
  EXPECT_TRUE(IsRecording(lidar));
  PacketLidarDevice packets;
  lidar.device = packets;
  EXPECT_FALSE(IsRecording(lidar));
  packets.pcap = "a.pcap";
  lidar.device = packets;
  EXPECT_TRUE(IsRecording(lidar));
  lidar.device = PcdFolderDevice();
  EXPECT_TRUE(IsRecording(lidar));
}

}  // namespace
}  // namespace rgbdt
