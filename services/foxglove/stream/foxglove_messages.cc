#include "services/foxglove/stream/foxglove_messages.h"

#include <algorithm>
#include <cstddef>
#include <cstring>

#include "calib/model/errors.h"
#include "calib/model/text.h"

// Points are copied as they lie here.
static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "points need swapping here");

namespace rgbdt {
namespace {

using Type = foxglove::PackedElementField;

struct [[gnu::packed]] SweepPoint {
  float x, y, z, intensity;
  std::uint16_t ring;
  double timestamp;
};

struct [[gnu::packed]] FusedPoint {
  float x, y, z;
  std::uint8_t red, green, blue, alpha;
  float intensity, temperature, temperature_sigma, thermal_counts;
  std::uint32_t valid;
  double timestamp;
};

// Fields one behind the other.
class Fields {
 public:
  explicit Fields(foxglove::PointCloud* cloud) : cloud_(cloud) {}
  void Add(std::initializer_list<const char*> names, Type::NumericType type, std::uint32_t size) {
    for (const char* name : names) {
      foxglove::PackedElementField* field = cloud_->add_fields();
      field->set_name(name);
      field->set_offset(stride_);
      field->set_type(type);
      stride_ += size;
    }
    cloud_->set_point_stride(stride_);
  }

 private:
  foxglove::PointCloud* cloud_;
  std::uint32_t stride_ = 0;
};

void SetPose(const Rigid3& pose, foxglove::Vector3* position, foxglove::Quaternion* rotation) {
  position->set_x(pose.translation.x());
  position->set_y(pose.translation.y());
  position->set_z(pose.translation.z());
  rotation->set_x(pose.rotation.x());
  rotation->set_y(pose.rotation.y());
  rotation->set_z(pose.rotation.z());
  rotation->set_w(pose.rotation.w());
}

void SetPose(const Rigid3& pose, foxglove::Pose* out) {
  SetPose(pose, out->mutable_position(), out->mutable_orientation());
}

void StartCloud(Utime utime, const std::string& frame, const Rigid3& pose,
                foxglove::PointCloud* cloud) {
  *cloud->mutable_timestamp() = ToTimestamp(utime);
  cloud->set_frame_id(frame);
  SetPose(pose, cloud->mutable_pose());
}

template <typename T>
char* Put(const T& value, char* to) {
  std::memcpy(to, &value, sizeof(value));
  return to + sizeof(value);
}

char* Put(const Eigen::Vector3f& v, char* to) {
  std::memcpy(to, v.data(), 3 * sizeof(float));
  return to + 3 * sizeof(float);
}

const char* EncodingOf(PixelFormat format) {
  switch (format) {
    case PixelFormat::kMono8:
      return "mono8";
    case PixelFormat::kMono16:
      return "mono16";
    case PixelFormat::kBayerRg8:
      return "bayer_rggb8";
    case PixelFormat::kBayerGr8:
      return "bayer_grbg8";
    case PixelFormat::kBayerGb8:
      return "bayer_gbrg8";
    case PixelFormat::kBayerBg8:
      return "bayer_bggr8";
    case PixelFormat::kBgr8:
      return "bgr8";
    case PixelFormat::kJpeg:
    case PixelFormat::kPng:
      break;
  }
  throw InputError("pixels are plain once an image is decoded; these are not");
}

std::string BytesOf(const cv::Mat& pixels) {
  const std::size_t row = static_cast<std::size_t>(pixels.cols) * pixels.elemSize();
  std::string bytes;
  bytes.reserve(row * static_cast<std::size_t>(pixels.rows));
  for (int y = 0; y < pixels.rows; ++y) {
    bytes.append(reinterpret_cast<const char*>(pixels.ptr(y)), row);
  }
  return bytes;
}

// Of a pinhole those that the plain model has, unless the rational one is in use.
std::size_t CoefficientsOf(const Lens& lens) {
  if (lens.model == Lens::Model::kFisheye) return 4;
  const bool rational = std::any_of(lens.distortion.begin() + 5, lens.distortion.end(),
                                    [](double k) { return k != 0; });
  return rational ? 8 : 5;
}

}  // namespace

google::protobuf::Timestamp ToTimestamp(Utime utime) {
  google::protobuf::Timestamp stamp;
  stamp.set_seconds(utime / kMicrosecondsPerSecond);
  stamp.set_nanos(static_cast<std::int32_t>(utime % kMicrosecondsPerSecond) * 1000);
  return stamp;
}

foxglove::PointCloud ToFoxglove(const Cloud& sweep, const std::string& frame) {
  foxglove::PointCloud out;
  StartCloud(sweep.sweep_utime, frame, Rigid3(), &out);
  Fields fields(&out);
  fields.Add({"x", "y", "z", "intensity"}, Type::FLOAT32, 4);
  fields.Add({"ring"}, Type::UINT16, 2);
  fields.Add({"timestamp"}, Type::FLOAT64, 8);
  if (sweep.organised) fields.Add({"line", "beam"}, Type::UINT32, 4);
  if (!sweep.directions.empty()) fields.Add({"dir_x", "dir_y", "dir_z"}, Type::FLOAT32, 4);
  if (!sweep.origins.empty()) fields.Add({"origin_x", "origin_y", "origin_z"}, Type::FLOAT32, 4);

  const std::size_t beams = sweep.organised ? static_cast<std::size_t>(sweep.beams) : sweep.size();
  out.mutable_data()->resize(sweep.size() * out.point_stride());
  char* to = out.mutable_data()->data();
  for (std::size_t i = 0; i < sweep.size(); ++i) {
    const Eigen::Vector3f& p = sweep.points[i];
    to = Put(SweepPoint{p.x(), p.y(), p.z(), sweep.intensity.empty() ? NAN : sweep.intensity[i],
                        sweep.ring.empty() ? std::uint16_t{65535} : sweep.ring[i],
                        ToSeconds(sweep.utime.empty() ? sweep.sweep_utime : sweep.utime[i])},
             to);
    if (sweep.organised) {
      const std::size_t line = static_cast<std::size_t>(sweep.first_line) + i / beams;
      to = Put(static_cast<std::uint32_t>(line), to);
      to = Put(static_cast<std::uint32_t>(i % beams), to);
    }
    if (!sweep.directions.empty()) to = Put(DirectionOf(sweep, i), to);
    if (!sweep.origins.empty()) to = Put(sweep.origins[i / beams], to);
  }
  return out;
}

foxglove::PointCloud ToFoxglove(const RgbdtCloud& cloud, const std::string& frame) {
  foxglove::PointCloud out;
  const bool placed = cloud.map_from_lidar.has_value();
  StartCloud(placed ? cloud.frame_utime : cloud.sweep_utime, placed ? kMapFrame : frame,
             cloud.map_from_lidar.value_or(Rigid3()), &out);
  Fields fields(&out);
  fields.Add({"x", "y", "z"}, Type::FLOAT32, 4);
  fields.Add({"red", "green", "blue", "alpha"}, Type::UINT8, 1);
  fields.Add({"intensity", "temperature", "temperature_sigma", "thermal_counts"}, Type::FLOAT32, 4);
  fields.Add({"valid"}, Type::UINT32, 4);
  fields.Add({"timestamp"}, Type::FLOAT64, 8);

  out.mutable_data()->resize(cloud.size() * sizeof(FusedPoint));
  char* to = out.mutable_data()->data();
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Eigen::Vector3f& p = cloud.points[i];
    const auto& rgb = cloud.rgb[i];
    const std::uint8_t alpha = rgb[0] + rgb[1] + rgb[2] == 0 ? 0 : 255;
    to = Put(FusedPoint{p.x(), p.y(), p.z(), rgb[0], rgb[1], rgb[2], alpha, cloud.intensity[i],
                        cloud.temperature_k[i], cloud.temperature_sigma_k[i],
                        cloud.thermal_counts[i], cloud.valid[i], ToSeconds(cloud.utime[i])},
             to);
  }
  return out;
}

foxglove::RawImage ToFoxglove(const Image& image, const std::string& frame) {
  foxglove::RawImage out;
  *out.mutable_timestamp() = ToTimestamp(image.utime);
  out.set_frame_id(frame);
  out.set_width(static_cast<std::uint32_t>(image.pixels.cols));
  out.set_height(static_cast<std::uint32_t>(image.pixels.rows));
  out.set_encoding(EncodingOf(image.format));
  out.set_step(out.width() * static_cast<std::uint32_t>(image.pixels.elemSize()));
  out.set_data(BytesOf(image.pixels));
  return out;
}

foxglove::CompressedImage ToFoxglove(const ImageFile& file, const std::string& frame) {
  constexpr std::uint8_t kPngBegin = 0x89;
  foxglove::CompressedImage out;
  *out.mutable_timestamp() = ToTimestamp(file.utime);
  out.set_frame_id(frame);
  out.set_format(!file.bytes.empty() && file.bytes[0] == kPngBegin ? "png" : "jpeg");
  out.set_data(file.bytes.data(), file.bytes.size());
  return out;
}

foxglove::CameraCalibration ToFoxglove(const CameraSpec& camera, Utime utime,
                                       const std::string& frame) {
  const Lens& lens = camera.lens;
  const std::size_t coefficients = CoefficientsOf(lens);
  foxglove::CameraCalibration out;
  *out.mutable_timestamp() = ToTimestamp(utime);
  out.set_frame_id(frame);
  out.set_width(static_cast<std::uint32_t>(camera.width));
  out.set_height(static_cast<std::uint32_t>(camera.height));
  out.set_distortion_model(coefficients == 4   ? "kannala_brandt"
                           : coefficients == 5 ? "plumb_bob"
                                               : "rational_polynomial");
  for (std::size_t i = 0; i < coefficients; ++i) out.add_d(lens.distortion[i]);
  for (const double k : {lens.fx, 0.0, lens.cx, 0.0, lens.fy, lens.cy, 0.0, 0.0, 1.0}) out.add_k(k);
  for (const double r : {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0}) out.add_r(r);
  for (const double p :
       {lens.fx, 0.0, lens.cx, 0.0, 0.0, lens.fy, lens.cy, 0.0, 0.0, 0.0, 1.0, 0.0}) {
    out.add_p(p);
  }
  return out;
}

foxglove::FrameTransform ToFoxglove(const Rigid3& parent_from_child, const std::string& parent,
                                    const std::string& child, Utime utime) {
  foxglove::FrameTransform out;
  *out.mutable_timestamp() = ToTimestamp(utime);
  out.set_parent_frame_id(parent);
  out.set_child_frame_id(child);
  SetPose(parent_from_child, out.mutable_translation(), out.mutable_rotation());
  return out;
}

foxglove::PoseInFrame ToFoxglove(const StampedPose& pose) {
  foxglove::PoseInFrame out;
  *out.mutable_timestamp() = ToTimestamp(pose.utime);
  out.set_frame_id(kMapFrame);
  SetPose(pose.map_from_lidar, out.mutable_pose());
  return out;
}

foxglove::Log ToLog(foxglove::Log::Level level, const std::string& process, const std::string& text,
                    Utime utime) {
  foxglove::Log out;
  *out.mutable_timestamp() = ToTimestamp(utime);
  out.set_level(level);
  out.set_name(ValidUtf8(process));
  out.set_message(ValidUtf8(text));
  return out;
}

}  // namespace rgbdt
