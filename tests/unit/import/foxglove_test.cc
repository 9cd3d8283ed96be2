// Foxglove's messages that are damaged or forged; good ones are in unit/export.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "services/foxglove/foxglove.pb.h"
#include "services/import/ros_messages.h"
#include "tests/unit/files/test_data.h"
#include "tests/unit/import/ros_bytes.h"

namespace rgbdt {
namespace {

using test::MessageOf;
using testing::HasSubstr;

constexpr BagEncoding kProto = BagEncoding::kProtobuf;

foxglove::PointCloud CloudMessage() {
  foxglove::PointCloud cloud;
  cloud.mutable_timestamp()->set_seconds(1'700'000'000);
  cloud.set_frame_id("/lidar");
  cloud.set_point_stride(12);
  for (const char* name : {"x", "y", "z"}) {
    foxglove::PackedElementField* field = cloud.add_fields();
    field->set_name(name);
    field->set_type(foxglove::PackedElementField::FLOAT32);
  }
  cloud.set_data(std::string(36, 'x'));
  return cloud;
}

TEST(FoxgloveReader, AnyByteMayBeAnyOther) {
  const std::string whole = CloudMessage().SerializeAsString();
  const BagTopic topic{"/lidar", "foxglove.PointCloud", kProto};
  std::mt19937 random(1);
  int refused = 0;
  for (std::size_t at = 0; at < whole.size(); ++at) {
    for (int i = 0; i < 20; ++i) {
      std::string bytes = whole;
      bytes[at] = static_cast<char>(random());
      if (i == 0) bytes.resize(at);
      try {
        ros::DecodeHeader(MessageOf(bytes), topic);
        const ros::PointCloud cloud = ros::DecodePointCloud(MessageOf(bytes), kProto);
        EXPECT_EQ(std::size_t{cloud.width} * cloud.point_step, cloud.size);
      } catch (const InputError&) {
        ++refused;
      }
    }
  }
  EXPECT_GT(refused, 100);
}

// Each field is small enough, all together are not; the data's own bytes do not count.
TEST(FoxgloveReader, OnlyTheDataMayBeLarge) {
  foxglove::PointCloud cloud = CloudMessage();
  cloud.set_data(std::string(3 << 20, 'x'));
  EXPECT_EQ(ros::DecodePointCloud(MessageOf(cloud.SerializeAsString()), kProto).size, 3U << 20);
  for (int i = 0; i < 40; ++i) cloud.add_fields()->set_name(std::string(60'000, 'n'));
  EXPECT_THAT(
      test::ErrorOf([&] { ros::DecodePointCloud(MessageOf(cloud.SerializeAsString()), kProto); }),
      HasSubstr("more than 1048576 bytes besides its data"));
}

TEST(FoxgloveReader, AMillionEmptyPartsTakeNoMemory) {
  std::string bytes;
  for (int i = 0; i < 1'000'000; ++i) bytes += std::string("\x2a\x00", 2);  // an empty field
  EXPECT_THAT(test::ErrorOf([&] { ros::DecodePointCloud(MessageOf(bytes), kProto); }),
              HasSubstr("more than 10000 fields"));
  foxglove::PointCloud cloud = CloudMessage();
  cloud.mutable_fields(0)->set_name(std::string(100'000, 'x'));
  const std::string large = cloud.SerializeAsString();
  EXPECT_THAT(test::ErrorOf([&] { ros::DecodePointCloud(MessageOf(large), kProto); }),
              HasSubstr("field of 100"));
}

TEST(FoxgloveReader, NumbersThatDoNotFitEachOther) {
  foxglove::PointCloud cloud = CloudMessage();
  cloud.set_point_stride(5);
  std::string bytes = cloud.SerializeAsString();
  EXPECT_THROW(ros::DecodePointCloud(MessageOf(bytes), kProto), InputError);
  cloud.set_point_stride(0);
  bytes = cloud.SerializeAsString();
  EXPECT_THROW(ros::DecodePointCloud(MessageOf(bytes), kProto), InputError);
  foxglove::CameraCalibration lens;
  lens.add_k(500);
  bytes = lens.SerializeAsString();
  EXPECT_THAT(test::ErrorOf([&] { ros::DecodeCameraInfo(MessageOf(bytes), kProto); }),
              HasSubstr("expected 9"));
  foxglove::FrameTransforms transforms;
  transforms.add_transforms()->set_child_frame_id("cam");  // no rotation
  bytes = transforms.SerializeAsString();
  EXPECT_THROW(ros::DecodeTransforms(MessageOf(bytes), kProto), InputError);
}

}  // namespace
}  // namespace rgbdt
