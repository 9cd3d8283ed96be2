#include "services/import/ros_messages.h"

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
std::vector<Transform> DecodeTransforms(const BagMessage& message, BagEncoding encoding) {
  if (encoding == BagEncoding::kProtobuf) return FoxgloveTransforms(message);
  return Decode(message, encoding, [](auto* in) { return TakeTransforms(in); });
}

}  // namespace rgbdt::ros
