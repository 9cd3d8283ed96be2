#include "services/import/ros_messages.h"

#include <cstring>
#include <map>

#include "services/bags/printable.h"
#include "services/import/internal/cursor.h"
#include "services/import/internal/foxglove_reader.h"

namespace rgbdt::ros {
namespace {

// What a message's own number of elements may be: each takes one byte at least.
template <typename C>
std::size_t Count(C* in, std::size_t most) {
  const auto count = in->template Number<std::uint32_t>();
  if (count > most || count > in->left()) {
    throw InputError("claims " + std::to_string(count) + " elements; at most " +
                     std::to_string(std::min(most, in->left())) + " are expected");
  }
  return count;
}

template <typename C>
Header TakeHeader(C* in) {
  Header header;
  if constexpr (C::kRos1) in->template Number<std::uint32_t>();  // seq
  const auto seconds = in->template Number<std::uint32_t>();
  const auto nanoseconds = in->template Number<std::uint32_t>();
  header.utime = Utime{seconds} * kMicrosecondsPerSecond + nanoseconds / 1000;
  header.frame = in->Text();
  if (!header.frame.empty() && header.frame.front() == '/') header.frame.erase(0, 1);
  return header;
}

template <typename C, typename M>
void TakeData(C* in, M* message) {
  message->size = in->template Number<std::uint32_t>();
  message->data = in->Bytes(message->size);
}

template <typename C>
Image TakeImage(C* in) {
  Image image;
  image.header = TakeHeader(in);
  image.height = in->template Number<std::uint32_t>();
  image.width = in->template Number<std::uint32_t>();
  image.encoding = in->Text();
  image.big_endian = in->template Number<std::uint8_t>() != 0;
  image.step = in->template Number<std::uint32_t>();
  TakeData(in, &image);
  return image;
}

template <typename C>
CompressedImage TakeCompressedImage(C* in) {
  CompressedImage image;
  image.header = TakeHeader(in);
  image.format = in->Text();
  TakeData(in, &image);
  return image;
}

template <typename C>
CameraInfo TakeCameraInfo(C* in) {
  constexpr std::size_t kMostCoefficients = 100;
  CameraInfo info;
  info.header = TakeHeader(in);
  info.height = in->template Number<std::uint32_t>();
  info.width = in->template Number<std::uint32_t>();
  info.distortion_model = in->Text();
  info.d.resize(Count(in, kMostCoefficients));
  for (double& d : info.d) d = in->template Number<double>();
  for (double& k : info.k) k = in->template Number<double>();
  for (int i = 0; i < 9 + 12; ++i) in->template Number<double>();  // R, P: of rectified images
  info.binning_x = in->template Number<std::uint32_t>();
  info.binning_y = in->template Number<std::uint32_t>();
  info.roi_x = in->template Number<std::uint32_t>();
  info.roi_y = in->template Number<std::uint32_t>();
  return info;
}

template <typename C>
PointCloud TakePointCloud(C* in) {
  constexpr std::size_t kMostFields = 1000;
  PointCloud cloud;
  cloud.header = TakeHeader(in);
  cloud.height = in->template Number<std::uint32_t>();
  cloud.width = in->template Number<std::uint32_t>();
  cloud.fields.resize(Count(in, kMostFields));
  for (PointCloud::Field& field : cloud.fields) {
    field.name = in->Text();
    field.offset = in->template Number<std::uint32_t>();
    field.datatype = in->template Number<std::uint8_t>();
    field.count = in->template Number<std::uint32_t>();
  }
  cloud.big_endian = in->template Number<std::uint8_t>() != 0;
  cloud.point_step = in->template Number<std::uint32_t>();
  cloud.row_step = in->template Number<std::uint32_t>();
  TakeData(in, &cloud);
  return cloud;
}

constexpr std::size_t kLivoxPointBytes = 19;

PointCloud EmptyLivoxCloud() {
  PointCloud cloud;
  cloud.height = 1;
  cloud.point_step = kLivoxPointBytes;
  cloud.fields = {{"offset_time", 0, 6, 1},   {"x", 4, 7, 1},    {"y", 8, 7, 1},    {"z", 12, 7, 1},
                  {"reflectivity", 16, 2, 1}, {"tag", 17, 2, 1}, {"line", 18, 2, 1}};
  return cloud;
}

// The points are laid out anew, without the gaps of CDR.
template <typename C>
PointCloud TakeLivoxCloud(C* in) {
  constexpr std::size_t kMostPoints = 20'000'000;
  PointCloud cloud = EmptyLivoxCloud();
  cloud.header = TakeHeader(in);
  in->template Number<std::uint64_t>();  // the first point's time, as the header has it
  const auto said = in->template Number<std::uint32_t>();
  in->Bytes(4);  // the LIDAR's number, reserved
  const std::size_t count = Count(in, kMostPoints);
  if (said != count) {
    throw InputError("says that it has " + std::to_string(said) + " points, and holds " +
                     std::to_string(count));
  }
  if (count * kLivoxPointBytes > in->left()) {
    throw InputError("ends before its " + std::to_string(count) + " points");
  }
  const auto bytes = std::make_shared<std::vector<std::uint8_t>>(count * kLivoxPointBytes);
  std::uint8_t* at = bytes->data();
  for (std::size_t i = 0; i < count; ++i) {
    const auto offset = in->template Number<std::uint32_t>();
    std::memcpy(at, &offset, 4);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto place = in->template Number<float>();
      std::memcpy(at + 4 + 4 * k, &place, 4);
    }
    std::memcpy(at + 16, in->Bytes(3), 3);
    at += kLivoxPointBytes;
  }
  cloud.width = static_cast<std::uint32_t>(count);
  cloud.data = bytes->data();
  cloud.size = bytes->size();
  cloud.row_step = static_cast<std::uint32_t>(cloud.size);
  cloud.owner = bytes;
  return cloud;
}

// How a type of message holds a packet.
struct PacketLayout {
  bool header = true;     // of the message
  bool many = true;       // an array; otherwise the message is one packet, without a time
  std::size_t fixed = 0;  // bytes of an array of fixed size; 0: it tells how many
  bool size_after = false;
  std::size_t flags = 0;  // bytes before a packet's
};

const std::map<std::string, PacketLayout>& PacketLayouts() {
  static const std::map<std::string, PacketLayout> layouts = {
      {"velodyne_msgs/VelodyneScan", {true, true, 1206, false}},
      {"pandar_msgs/PandarScan", {true, true, 1500, true}},
      {"nebula_msgs/NebulaPackets", {true, true, 0, false}},
      {"hesai_ros_driver/UdpFrame", {false, true, 0, true}},
      {"ouster_sensor_msgs/PacketMsg", {false, false, 0, false}},
      {"ouster_msgs/PacketMsg", {false, false, 0, false}},
      {"ouster_ros/PacketMsg", {false, false, 0, false}},
      {"robosense_msgs/RobosenseScan", {true, true, 1248, false}},
      {"rslidar_msgs/rslidarScan", {true, true, 1248, false}},
      {"rslidar_msg/RslidarPacket", {true, false, 0, false, 2}},
  };
  return layouts;
}

template <typename C>
Utime TakeTime(C* in) {
  const auto seconds = in->template Number<std::uint32_t>();
  return Utime{seconds} * kMicrosecondsPerSecond + in->template Number<std::uint32_t>() / 1000;
}

template <typename C>
Packets::Packet TakePacket(C* in, const PacketLayout& layout) {
  Packets::Packet packet;
  if (layout.many) packet.utime = TakeTime(in);
  in->Bytes(layout.flags);  // whether it is of data, and begins a sweep
  packet.size = layout.fixed != 0 ? layout.fixed : in->template Number<std::uint32_t>();
  packet.data = in->Bytes(packet.size);
  if (!layout.size_after) return packet;
  const auto size = in->template Number<std::uint32_t>();
  if (size > packet.size) {
    throw InputError("a packet claims " + std::to_string(size) + " of " +
                     std::to_string(packet.size) + " bytes");
  }
  packet.size = size;
  return packet;
}

template <typename C>
Packets TakePackets(C* in, const PacketLayout& layout) {
  constexpr std::size_t kMostPackets = 100'000;
  Packets packets;
  if (layout.header) packets.header = TakeHeader(in);
  const std::size_t count = layout.many ? Count(in, kMostPackets) : 1;
  for (std::size_t i = 0; i < count; ++i) packets.packets.push_back(TakePacket(in, layout));
  return packets;
}

template <typename C>
std::vector<Transform> TakeTransforms(C* in) {
  constexpr std::size_t kMostTransforms = 10000;
  std::vector<Transform> transforms(Count(in, kMostTransforms));
  for (Transform& transform : transforms) {
    transform.parent = TakeHeader(in).frame;
    transform.child = in->Text();
    Rigid3& pose = transform.parent_from_child;
    for (int i = 0; i < 3; ++i) pose.translation[i] = in->template Number<double>();
    double q[4];  // x y z w
    for (double& value : q) value = in->template Number<double>();
    pose.rotation = Eigen::Quaterniond(q[3], q[0], q[1], q[2]);
    CheckTransform(&transform);
  }
  return transforms;
}

// Calls `take` with a cursor of the message's layout.
template <typename Take>
auto Decode(const BagMessage& message, BagEncoding encoding, Take take) {
  if (encoding == BagEncoding::kRos1) {
    PackedCursor in(message.data, message.size);
    return take(&in);
  }
  if (encoding != BagEncoding::kCdr) {
    throw InputError("is neither a message of ROS 1 nor CDR of ROS 2");
  }
  CdrCursor in(message.data, message.size);
  return take(&in);
}

}  // namespace

void CheckTransform(Transform* transform) {
  for (std::string* frame : {&transform->parent, &transform->child}) {
    if (!frame->empty() && frame->front() == '/') frame->erase(0, 1);
  }
  Rigid3& pose = transform->parent_from_child;
  if (!(std::abs(pose.rotation.norm() - 1) < 0.01) || !pose.translation.allFinite()) {
    throw InputError("the transform from " + Printable(transform->child) + " to " +
                     Printable(transform->parent) + " is no rotation and translation");
  }
  pose.rotation.normalize();
}

Header DecodeHeader(const BagMessage& message, const BagTopic& topic) {
  if (topic.encoding == BagEncoding::kProtobuf) return FoxgloveHeader(message, topic.type);
  return Decode(message, topic.encoding, [](auto* in) { return TakeHeader(in); });
}
Image DecodeImage(const BagMessage& message, BagEncoding encoding) {
  if (encoding == BagEncoding::kProtobuf) return FoxgloveImage(message);
  return Decode(message, encoding, [](auto* in) { return TakeImage(in); });
}
CompressedImage DecodeCompressedImage(const BagMessage& message, BagEncoding encoding) {
  if (encoding == BagEncoding::kProtobuf) return FoxgloveCompressedImage(message);
  return Decode(message, encoding, [](auto* in) { return TakeCompressedImage(in); });
}
CameraInfo DecodeCameraInfo(const BagMessage& message, BagEncoding encoding) {
  if (encoding == BagEncoding::kProtobuf) return FoxgloveCameraInfo(message);
  return Decode(message, encoding, [](auto* in) { return TakeCameraInfo(in); });
}
PointCloud DecodePointCloud(const BagMessage& message, BagEncoding encoding) {
  if (encoding == BagEncoding::kProtobuf) return FoxglovePointCloud(message);
  return Decode(message, encoding, [](auto* in) { return TakePointCloud(in); });
}
PointCloud DecodeLivoxCloud(const BagMessage& message, BagEncoding encoding) {
  return Decode(message, encoding, [](auto* in) { return TakeLivoxCloud(in); });
}
bool IsLivoxCloud(const std::string& type) {
  return type == "livox_ros_driver/CustomMsg" || type == "livox_ros_driver2/CustomMsg";
}
PointCloud DecodeCloud(const BagMessage& message, const BagTopic& topic) {
  return IsLivoxCloud(topic.type) ? DecodeLivoxCloud(message, topic.encoding)
                                  : DecodePointCloud(message, topic.encoding);
}
bool IsPackets(const std::string& type) { return PacketLayouts().count(type) != 0; }

// Of UdpFrame there are versions with a header and without: that holds which the message ends with.
Packets DecodePackets(const BagMessage& message, const BagTopic& topic) {
  const auto found = PacketLayouts().find(topic.type);
  if (found == PacketLayouts().end()) throw InputError("is no message of packets");
  const auto take = [&](const PacketLayout& layout) {
    return Decode(message, topic.encoding, [&](auto* in) {
      Packets packets = TakePackets(in, layout);
      if (in->left() != 0) {
        throw InputError("has " + std::to_string(in->left()) + " bytes behind its packets");
      }
      return packets;
    });
  };
  PacketLayout layout = found->second;
  if (topic.type != "hesai_ros_driver/UdpFrame") return take(layout);
  try {
    return take(layout);
  } catch (const InputError&) {
    layout.header = true;
    return take(layout);
  }
}
std::string DecodeText(const BagMessage& message, BagEncoding encoding) {
  return Decode(message, encoding, [](auto* in) { return in->Text(); });
}
std::vector<Transform> DecodeTransforms(const BagMessage& message, BagEncoding encoding) {
  if (encoding == BagEncoding::kProtobuf) return FoxgloveTransforms(message);
  return Decode(message, encoding, [](auto* in) { return TakeTransforms(in); });
}

}  // namespace rgbdt::ros
