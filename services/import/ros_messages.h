#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "calib/model/rigid3.h"
#include "calib/model/time.h"
#include "services/bags/bag_reader.h"

namespace rgbdt::ros {

// Messages of ROS as they are, with its names, and Foxglove's (Protobuf) as those of ROS that say
// the same. Bytes (`data`) lie in the message that they were decoded from, or in what `owner`
// holds. Each function throws InputError, without the topic's name, where the message is damaged,
// cut short or inconsistent.

/// std_msgs/Header
struct Header {
  Utime utime = 0;    ///< when the sensor measured; 0: its driver did not say
  std::string frame;  ///< "lidar_link"
};

/// sensor_msgs/Image
struct Image {
  Header header;
  std::uint32_t width = 0, height = 0;  ///< [px]
  std::string encoding;                 ///< "mono16", "bayer_rggb8", ...
  bool big_endian = false;
  std::uint32_t step = 0;  ///< from row to row [byte]
  const std::uint8_t* data = nullptr;
  std::size_t size = 0;  ///< of `data` [byte]
  std::shared_ptr<const void> owner{};
};

/// sensor_msgs/CompressedImage
struct CompressedImage {
  Header header;
  std::string format;  ///< "bayer_rggb8; jpeg compressed bgr8"
  const std::uint8_t* data = nullptr;
  std::size_t size = 0;  ///< of `data` [byte]
  std::shared_ptr<const void> owner{};
};

/// sensor_msgs/CameraInfo
struct CameraInfo {
  Header header;
  std::uint32_t width = 0, height = 0;  ///< [px]
  std::string distortion_model;         ///< "plumb_bob", ...
  std::vector<double> d;
  std::array<double, 9> k{};  ///< row by row; all zero: never calibrated
  std::uint32_t binning_x = 0, binning_y = 0;
  std::uint32_t roi_x = 0, roi_y = 0;
};

/// sensor_msgs/PointCloud2
struct PointCloud {
  struct Field {
    std::string name;
    std::uint32_t offset = 0;   ///< in a point [byte]
    std::uint8_t datatype = 0;  ///< 1 to 8: int8 uint8 int16 uint16 int32 uint32 float32 float64
    std::uint32_t count = 1;
  };
  Header header;
  std::uint32_t width = 0, height = 0;
  std::vector<Field> fields;
  bool big_endian = false;
  std::uint32_t point_step = 0, row_step = 0;  ///< [byte]
  const std::uint8_t* data = nullptr;
  std::size_t size = 0;  ///< of `data` [byte]
  std::shared_ptr<const void> owner{};
};

/// A LIDAR's packets, of any message that holds them.
struct Packets {
  struct Packet {
    Utime utime = 0;  ///< when it arrived; 0: nobody says
    const std::uint8_t* data = nullptr;
    std::size_t size = 0;
  };
  Header header;  ///< empty where the message has none
  std::vector<Packet> packets;
};

/// geometry_msgs/TransformStamped: point_in_parent = parent_from_child * point_in_child.
struct Transform {
  std::string parent, child;
  Rigid3 parent_from_child;
};

/// Of any message that begins with a header, and of Foxglove's images and clouds.
Header DecodeHeader(const BagMessage& message, const BagTopic& topic);
Image DecodeImage(const BagMessage& message, BagEncoding encoding);
CompressedImage DecodeCompressedImage(const BagMessage& message, BagEncoding encoding);
CameraInfo DecodeCameraInfo(const BagMessage& message, BagEncoding encoding);
PointCloud DecodePointCloud(const BagMessage& message, BagEncoding encoding);
/// livox_ros_driver/CustomMsg, of driver 2 likewise: as the cloud of its points, with fields
/// offset_time [ns], x, y, z, reflectivity, tag, line
PointCloud DecodeLivoxCloud(const BagMessage& message, BagEncoding encoding);
/// Whichever of the two the topic's type says.
PointCloud DecodeCloud(const BagMessage& message, const BagTopic& topic);
bool IsLivoxCloud(const std::string& type);
/// velodyne_msgs/VelodyneScan, ouster_sensor_msgs/PacketMsg (ouster_ros, ouster_msgs),
/// pandar_msgs/PandarScan, nebula_msgs/NebulaPackets, hesai_ros_driver/UdpFrame,
/// robosense_msgs/RobosenseScan, rslidar_msgs/rslidarScan, rslidar_msg/RslidarPacket
Packets DecodePackets(const BagMessage& message, const BagTopic& topic);
bool IsPackets(const std::string& type);
/// std_msgs/String
std::string DecodeText(const BagMessage& message, BagEncoding encoding);
/// tf2_msgs/TFMessage
std::vector<Transform> DecodeTransforms(const BagMessage& message, BagEncoding encoding);

}  // namespace rgbdt::ros
