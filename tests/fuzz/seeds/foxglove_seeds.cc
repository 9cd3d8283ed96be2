#include <vector>

#include "calib/files/image_files.h"
#include "services/bags/mcap_writer.h"
#include "services/foxglove/foxglove.pb.h"
#include "tests/fuzz/seeds/seeds.h"

namespace rgbdt::fuzz {
namespace {

using Inputs = std::map<std::string, std::string>;

constexpr std::int64_t kSeconds = 1'700'000'000;

struct FoxgloveMessage {
  char kind;  // as the target ros_message counts them
  std::string name, topic, schema, bytes;
};

template <typename M>
M Stamped(const std::string& frame) {
  M message;
  message.mutable_timestamp()->set_seconds(kSeconds);
  message.mutable_timestamp()->set_nanos(5000);
  message.set_frame_id(frame);
  return message;
}

foxglove::RawImage RawImage(const std::string& encoding, std::uint32_t step) {
  auto image = Stamped<foxglove::RawImage>("/cam");
  image.set_width(4);
  image.set_height(2);
  image.set_encoding(encoding);
  image.set_step(step);
  image.set_data(std::string(2 * step, 'p'));
  return image;
}

foxglove::CompressedImage CompressedImage() {
  auto image = Stamped<foxglove::CompressedImage>("cam");
  image.set_format("png");
  image.set_data(EncodePng(cv::Mat(4, 4, CV_8UC1, 9)));
  return image;
}

foxglove::CameraCalibration Lens() {
  auto lens = Stamped<foxglove::CameraCalibration>("cam");
  lens.set_width(640);
  lens.set_height(480);
  lens.set_distortion_model("plumb_bob");
  for (const double d : {0.5, -0.25, 0.0, 0.0}) lens.add_d(d);
  for (const double k : {500.0, 0.0, 320.0, 0.0, 501.0, 240.0, 0.0, 0.0, 1.0}) lens.add_k(k);
  return lens;
}

foxglove::PointCloud Points() {
  struct Field {
    const char* name;
    foxglove::PackedElementField::NumericType type;
    std::uint32_t offset;
  };
  using Type = foxglove::PackedElementField;
  constexpr Field kFields[] = {{"x", Type::FLOAT32, 0}, {"y", Type::FLOAT32, 4},
                               {"z", Type::FLOAT32, 8}, {"ring", Type::UINT16, 12},
                               {"t", Type::UINT32, 16}, {"intensity", Type::UINT8, 20}};
  constexpr std::uint32_t kStride = 24;
  auto cloud = Stamped<foxglove::PointCloud>("lidar");
  cloud.set_point_stride(kStride);
  for (const Field& field : kFields) {
    auto* added = cloud.add_fields();
    added->set_name(field.name);
    added->set_type(field.type);
    added->set_offset(field.offset);
  }
  cloud.set_data(std::string(std::size_t{kStride} * 6, '?'));
  return cloud;
}

foxglove::FrameTransforms Transforms() {
  foxglove::FrameTransforms all;
  auto* transform = all.add_transforms();
  transform->set_parent_frame_id("/base");
  transform->set_child_frame_id("lidar");
  transform->mutable_translation()->set_x(1);
  transform->mutable_rotation()->set_z(1);
  return all;
}

std::vector<FoxgloveMessage> Messages() {
  return {{0, "image", "/rgb/image", "RawImage", RawImage("bgr8", 12).SerializeAsString()},
          {1, "packed", "/left/packed", "CompressedImage", CompressedImage().SerializeAsString()},
          {2, "info", "/rgb/lens", "CameraCalibration", Lens().SerializeAsString()},
          {3, "cloud", "/points", "PointCloud", Points().SerializeAsString()},
          {4, "transform", "/tf", "FrameTransforms", Transforms().SerializeAsString()}};
}

void AddMessages(Inputs* seeds) {
  const auto add = [&](const std::string& name, char kind, const std::string& bytes) {
    (*seeds)["foxglove_" + name] = std::string{kind, '\2'} + bytes;
  };
  for (const FoxgloveMessage& message : Messages()) add(message.name, message.kind, message.bytes);
  for (const char* format : {"mono16", "rgba8", "yuv422", "bayer_grbg8", "8UC1", "rgb8"}) {
    add(format, 0, RawImage(format, 16).SerializeAsString());
  }
  foxglove::PointCloud posed = Points();
  posed.mutable_pose()->mutable_orientation()->set_w(1);
  add("posed", 3, posed.SerializeAsString());
  posed.mutable_pose()->mutable_position()->set_x(1);
  add("elsewhere", 3, posed.SerializeAsString());
  posed = Points();
  for (auto& field : *posed.mutable_fields()) {
    field.set_type(foxglove::PackedElementField::FLOAT64);
    field.set_offset(0);
  }
  add("overlapping", 3, posed.SerializeAsString());
  foxglove::CameraCalibration short_lens = Lens();
  short_lens.mutable_k()->Truncate(3);
  add("short_lens", 2, short_lens.SerializeAsString());
}

std::string Bag() {
  std::string bytes;
  McapWriter writer([&](std::string_view more) { bytes += more; }, "seeds");
  for (const FoxgloveMessage& message : Messages()) {
    const std::uint16_t schema = writer.AddSchema("foxglove." + message.schema, "protobuf", "");
    const std::uint16_t channel = writer.AddChannel(message.topic, schema, "protobuf");
    writer.Write(channel, kSeconds * 1'000'000, kSeconds * 1'000'000, message.bytes);
  }
  writer.Finish();
  return bytes;
}

}  // namespace

void AddFoxgloveSeeds(Seeds* seeds) {
  AddMessages(&(*seeds)["ros_message"]);
  (*seeds)["bag"]["foxglove.mcap"] = Bag();
}

}  // namespace rgbdt::fuzz
