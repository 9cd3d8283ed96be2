#include "services/import/internal/foxglove_reader.h"

#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/wire_format_lite.h>

#include <algorithm>

#include "calib/model/errors.h"
#include "services/bags/printable.h"
#include "services/foxglove/foxglove.pb.h"

namespace rgbdt::ros {
namespace {

using google::protobuf::internal::WireFormatLite;
using google::protobuf::io::CodedInputStream;

constexpr int kNone = 0;
constexpr int kMostFields = 10'000;
constexpr std::uint32_t kMostFieldBytes = 64 * 1024;
constexpr std::size_t kMostBytesOfAll = 1024 * 1024;

// A message may take many times its bytes once it is decoded, as does one of a million empty parts:
// only its one field of bytes may be large.
void CheckFields(const BagMessage& message, int bytes_field) {
  CodedInputStream in(message.data, static_cast<int>(message.size));
  int fields = 0;
  std::size_t bytes = 0;
  while (const std::uint32_t tag = in.ReadTag()) {
    const int number = WireFormatLite::GetTagFieldNumber(tag);
    std::uint32_t size = 0;
    const bool is_sized =
        WireFormatLite::GetTagWireType(tag) == WireFormatLite::WIRETYPE_LENGTH_DELIMITED;
    const bool whole = is_sized ? in.ReadVarint32(&size) && in.Skip(static_cast<int>(size))
                                : WireFormatLite::SkipField(&in, tag);
    if (!whole) throw InputError("is damaged or cut short");
    if (number != bytes_field) bytes += size;
    if (bytes > kMostBytesOfAll) {
      throw InputError("has more than " + std::to_string(kMostBytesOfAll) +
                       " bytes besides its data, where few are expected");
    }
    if (++fields > kMostFields || (number != bytes_field && size > kMostFieldBytes)) {
      throw InputError("has a field of " + std::to_string(size) + " bytes, or more than " +
                       std::to_string(kMostFields) + " fields, where few are expected");
    }
  }
}

template <typename M>
std::shared_ptr<M> Parse(const BagMessage& message, int bytes_field) {
  CheckFields(message, bytes_field);
  auto parsed = std::make_shared<M>();
  const google::protobuf::LogSilencer silencer;  // what is wrong is told by who calls
  if (!parsed->ParseFromArray(message.data, static_cast<int>(message.size))) {
    throw InputError("is no " + M::descriptor()->full_name() + ", or cut short");
  }
  return parsed;
}

Utime ToUtime(const google::protobuf::Timestamp& stamp) {
  constexpr std::int64_t kMostSeconds = std::int64_t{1} << 33;
  if (stamp.seconds() < 0 || stamp.seconds() > kMostSeconds) return 0;
  return stamp.seconds() * kMicrosecondsPerSecond +
         std::clamp(stamp.nanos(), 0, 999'999'999) / 1000;
}

template <typename M>
Header HeaderOf(const M& message) {
  Header header{ToUtime(message.timestamp()), message.frame_id()};
  if (!header.frame.empty() && header.frame.front() == '/') header.frame.erase(0, 1);
  return header;
}

// Bytes that `parsed` holds.
template <typename M, typename T>
void SetData(const std::shared_ptr<M>& parsed, T* out) {
  out->data = reinterpret_cast<const std::uint8_t*>(parsed->data().data());
  out->size = parsed->data().size();
  out->owner = parsed;
}

constexpr int kImageBytes = foxglove::RawImage::kDataFieldNumber;
constexpr int kFileBytes = foxglove::CompressedImage::kDataFieldNumber;
constexpr int kPointBytes = foxglove::PointCloud::kDataFieldNumber;

// sensor_msgs/PointField's numbers, of foxglove.PackedElementField's.
std::uint8_t DatatypeOf(foxglove::PackedElementField::NumericType type) {
  switch (type) {
    case foxglove::PackedElementField::INT8:
      return 1;
    case foxglove::PackedElementField::UINT8:
      return 2;
    case foxglove::PackedElementField::INT16:
      return 3;
    case foxglove::PackedElementField::UINT16:
      return 4;
    case foxglove::PackedElementField::INT32:
      return 5;
    case foxglove::PackedElementField::UINT32:
      return 6;
    case foxglove::PackedElementField::FLOAT32:
      return 7;
    case foxglove::PackedElementField::FLOAT64:
      return 8;
    default:
      return 0;  // refused where the cloud's fields are read
  }
}

Rigid3 PoseOf(const foxglove::Vector3& position, const foxglove::Quaternion& rotation) {
  return {Eigen::Quaterniond(rotation.w(), rotation.x(), rotation.y(), rotation.z()),
          {position.x(), position.y(), position.z()}};
}

// Points lie in the frame by their own pose, which most leave out.
void RequireNoPose(const foxglove::PointCloud& cloud) {
  if (!cloud.has_pose()) return;
  Rigid3 pose = PoseOf(cloud.pose().position(), cloud.pose().orientation());
  if (pose.rotation.coeffs().isZero(0)) pose.rotation.setIdentity();  // left out
  const bool none = pose.translation.isZero(0) &&
                    (pose.rotation.coeffs() - Eigen::Vector4d(0, 0, 0, 1)).isZero(1e-12);
  if (!none) {
    throw InputError("its points have a pose of their own in the frame " +
                     Printable(cloud.frame_id()) + "; expected those of a LIDAR in its own frame");
  }
}

}  // namespace

Header FoxgloveHeader(const BagMessage& message, const std::string& type) {
  if (type == "foxglove.RawImage") {
    return HeaderOf(*Parse<foxglove::RawImage>(message, kImageBytes));
  }
  if (type == "foxglove.CompressedImage") {
    return HeaderOf(*Parse<foxglove::CompressedImage>(message, kFileBytes));
  }
  return HeaderOf(*Parse<foxglove::PointCloud>(message, kPointBytes));
}

Image FoxgloveImage(const BagMessage& message) {
  const auto parsed = Parse<foxglove::RawImage>(message, kImageBytes);
  Image image;
  image.header = HeaderOf(*parsed);
  image.width = parsed->width();
  image.height = parsed->height();
  image.encoding = parsed->encoding();
  image.step = parsed->step();
  SetData(parsed, &image);
  return image;
}

CompressedImage FoxgloveCompressedImage(const BagMessage& message) {
  const auto parsed = Parse<foxglove::CompressedImage>(message, kFileBytes);
  CompressedImage image;
  image.header = HeaderOf(*parsed);
  image.format = parsed->format();
  SetData(parsed, &image);
  return image;
}

CameraInfo FoxgloveCameraInfo(const BagMessage& message) {
  const auto parsed = Parse<foxglove::CameraCalibration>(message, kNone);
  CameraInfo info;
  info.header = HeaderOf(*parsed);
  info.width = parsed->width();
  info.height = parsed->height();
  info.distortion_model = parsed->distortion_model();
  info.d.assign(parsed->d().begin(), parsed->d().end());
  if (parsed->k_size() != 0 && parsed->k_size() != static_cast<int>(info.k.size())) {
    throw InputError("K has " + std::to_string(parsed->k_size()) + " numbers; expected 9");
  }
  std::copy(parsed->k().begin(), parsed->k().end(), info.k.begin());
  return info;
}

PointCloud FoxglovePointCloud(const BagMessage& message) {
  const auto parsed = Parse<foxglove::PointCloud>(message, kPointBytes);
  RequireNoPose(*parsed);
  PointCloud cloud;
  cloud.header = HeaderOf(*parsed);
  for (const foxglove::PackedElementField& field : parsed->fields()) {
    cloud.fields.push_back({field.name(), field.offset(), DatatypeOf(field.type()), 1});
  }
  cloud.point_step = parsed->point_stride();
  cloud.height = 1;
  SetData(parsed, &cloud);
  if (cloud.point_step == 0 || cloud.size % cloud.point_step != 0) {
    throw InputError("holds " + std::to_string(cloud.size) + " bytes of points of " +
                     std::to_string(cloud.point_step) + " bytes");
  }
  cloud.width = static_cast<std::uint32_t>(cloud.size / cloud.point_step);
  cloud.row_step = static_cast<std::uint32_t>(cloud.size);
  return cloud;
}

std::vector<Transform> FoxgloveTransforms(const BagMessage& message) {
  const auto parsed = Parse<foxglove::FrameTransforms>(message, kNone);
  std::vector<Transform> transforms;
  for (const foxglove::FrameTransform& transform : parsed->transforms()) {
    transforms.push_back({transform.parent_frame_id(), transform.child_frame_id(),
                          PoseOf(transform.translation(), transform.rotation())});
    CheckTransform(&transforms.back());
  }
  return transforms;
}

}  // namespace rgbdt::ros
