// What is exported, read back by the way that rgbdt import reads anybody's.
#include "services/foxglove/stream/foxglove_messages.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "services/import/image_data.h"
#include "services/import/sensor_data.h"
#include "tests/unit/files/test_data.h"
#include "tests/unit/matchers.h"

namespace rgbdt {
namespace {

constexpr Utime kStamp = 1'700'000'000'123'457;
constexpr float kNotANumber = std::numeric_limits<float>::quiet_NaN();

// Keeps the bytes as long as the message.
struct Sent {
  std::string bytes;
  BagMessage message;
  template <typename M>
  explicit Sent(const M& proto) : bytes(proto.SerializeAsString()) {
    message.data = reinterpret_cast<const std::uint8_t*>(bytes.data());
    message.size = bytes.size();
  }
};

Cloud Sweep() {
  Cloud sweep;
  sweep.sweep_utime = kStamp;
  sweep.lines = 2;
  sweep.beams = 2;
  sweep.points = {{1, 2, 3}, {kNotANumber, kNotANumber, kNotANumber}, {4, 5, 6}, {-1, 0, 2}};
  sweep.directions.assign(4, {kNotANumber, kNotANumber, kNotANumber});
  sweep.directions[1] = {0, 0.6F, 0.8F};
  sweep.origins = {{0, 0, 0.1F}, {0, 0, 0.2F}};
  sweep.intensity = {0.25F, kNotANumber, 1, 0};
  sweep.ring = {0, 1, 0, 1};
  sweep.utime = {kStamp, kStamp + 1, kStamp + 9'999'999, kStamp + 3};
  return sweep;
}

TEST(Foxglove, ASweepComesBackBitForBit) {
  const Cloud sweep = Sweep();
  const Sent sent(ToFoxglove(sweep, "lidar"));
  const ros::PointCloud read = ros::DecodePointCloud(sent.message, BagEncoding::kProtobuf);
  EXPECT_EQ(read.header.frame, "lidar");
  EXPECT_EQ(read.header.utime, kStamp);
  const Cloud back = ToCloud(read, "/lidar");
  EXPECT_EQ(back.sweep_utime, kStamp);
  EXPECT_TRUE(back.organised);
  EXPECT_EQ(back.lines, 2);
  EXPECT_EQ(back.beams, 2);
  EXPECT_EQ(back.points[3], sweep.points[3]);
  EXPECT_FALSE(back.IsHit(1));
  EXPECT_EQ(back.directions[1], sweep.directions[1]);
  EXPECT_EQ(back.origins, sweep.origins);
  EXPECT_EQ(back.utime, sweep.utime);
  EXPECT_EQ(back.ring, sweep.ring);
  EXPECT_EQ(back.intensity[0], 0.25F);
  EXPECT_TRUE(std::isnan(back.intensity[1]));
}

TEST(Foxglove, ACloudWithoutOrderHasNone) {
  Cloud sweep = Sweep();
  sweep.organised = false;
  sweep.origins.clear();
  sweep.directions.clear();
  const Sent sent(ToFoxglove(sweep, "lidar"));
  const Cloud back = ToCloud(ros::DecodePointCloud(sent.message, BagEncoding::kProtobuf), "/lidar");
  EXPECT_FALSE(back.organised);
  EXPECT_EQ(back.size(), 4U);
  EXPECT_TRUE(back.directions.empty());
}

TEST(Foxglove, AFusedCloudHasColourTemperatureAndItsPlace) {
  RgbdtCloud cloud;
  cloud.sweep_utime = kStamp;
  cloud.points = {{1, 2, 3}, {4, 5, 6}};
  cloud.intensity = {0.5F, 0.25F};
  cloud.utime = {kStamp, kStamp + 5};
  cloud.rgb = {{10, 20, 30}, {0, 0, 0}};
  cloud.temperature_k = {300, kNotANumber};
  cloud.temperature_sigma_k = {0.5F, kNotANumber};
  cloud.thermal_counts = {3000, kNotANumber};
  cloud.valid = {3, 0};
  foxglove::PointCloud out = ToFoxglove(cloud, "lidar");
  EXPECT_EQ(out.frame_id(), "lidar");
  ASSERT_EQ(out.data().size(), 2 * out.point_stride());
  std::map<std::string, std::uint32_t> offsets;
  for (const auto& field : out.fields()) offsets[field.name()] = field.offset();
  const auto at = [&](const std::string& name, std::size_t point, auto value) {
    std::memcpy(&value, out.data().data() + point * out.point_stride() + offsets.at(name),
                sizeof(value));
    return value;
  };
  EXPECT_EQ(at("green", 0, std::uint8_t{}), 20);
  EXPECT_EQ(at("alpha", 0, std::uint8_t{}), 255);
  EXPECT_EQ(at("alpha", 1, std::uint8_t{}), 0);
  EXPECT_EQ(at("temperature", 0, float{}), 300);
  EXPECT_EQ(at("temperature_sigma", 0, float{}), 0.5F);
  EXPECT_EQ(at("valid", 0, std::uint32_t{}), 3U);
  EXPECT_NEAR(at("timestamp", 1, double{}), ToSeconds(kStamp + 5), 3e-7);

  cloud.map_from_lidar = Rigid3{Eigen::Quaterniond::Identity(), {7, 8, 9}};
  cloud.frame_utime = kStamp + 10;
  out = ToFoxglove(cloud, "lidar");
  EXPECT_EQ(out.frame_id(), "map");
  EXPECT_EQ(out.pose().position().y(), 8);
  EXPECT_EQ(out.timestamp().nanos(), 123'467'000);
  // Such a cloud is no LIDAR's in its own frame.
  const Sent sent(out);
  EXPECT_THAT(test::ErrorOf([&] { ros::DecodePointCloud(sent.message, BagEncoding::kProtobuf); }),
              testing::HasSubstr("pose"));
}

TEST(Foxglove, ImagesOfEveryKindComeBack) {
  for (const auto& [format, type] :
       {std::pair(PixelFormat::kMono8, CV_8UC1), std::pair(PixelFormat::kMono16, CV_16UC1),
        std::pair(PixelFormat::kBayerRg8, CV_8UC1), std::pair(PixelFormat::kBayerGr8, CV_8UC1),
        std::pair(PixelFormat::kBayerGb8, CV_8UC1), std::pair(PixelFormat::kBayerBg8, CV_8UC1),
        std::pair(PixelFormat::kBgr8, CV_8UC3)}) {
    Image image;
    image.utime = kStamp;
    image.format = format;
    const cv::Mat wide(3, 7, type, cv::Scalar(10, 20, 30));
    image.pixels = wide(cv::Rect(1, 0, 5, 3));  // its rows are apart
    const Sent sent(ToFoxglove(image, "optical"));
    const Image back = ToImage(ros::DecodeImage(sent.message, BagEncoding::kProtobuf), "/cam");
    EXPECT_EQ(back.format, format);
    EXPECT_EQ(back.utime, kStamp);
    EXPECT_EQ(cv::norm(back.pixels, image.pixels), 0);
  }
}

TEST(Foxglove, LensesOfEveryModelComeBack) {
  CameraSpec camera;
  camera.width = 640;
  camera.height = 480;
  for (const int coefficients : {4, 5, 8}) {
    camera.lens = {
        coefficients == 4 ? Lens::Model::kFisheye : Lens::Model::kPinhole, 500, 510, 319, 241, {}};
    for (int i = 0; i < coefficients; ++i) {
      camera.lens.distortion[static_cast<std::size_t>(i)] = 0.1 / (1 + i);
    }
    const Sent sent(ToFoxglove(camera, kStamp, "optical"));
    const auto info = ros::DecodeCameraInfo(sent.message, BagEncoding::kProtobuf);
    const auto lens = ToLens(info, {"/cam/camera_info", "", "cam", 0, 1, std::nullopt});
    ASSERT_TRUE(lens.has_value());
    EXPECT_EQ(lens->lens, camera.lens) << coefficients;
  }
}

TEST(Foxglove, TransformsSayWhichWay) {
  foxglove::FrameTransforms sent_transforms;
  const Rigid3 base_from_lidar =
      RotationAbout({0, 0, 1}, 0.5) * Rigid3{Eigen::Quaterniond::Identity(), {1, 2, 3}};
  *sent_transforms.add_transforms() = ToFoxglove(base_from_lidar, "base", "lidar", kStamp);
  const Sent sent(sent_transforms);
  const auto transforms = ros::DecodeTransforms(sent.message, BagEncoding::kProtobuf);
  ASSERT_EQ(transforms.size(), 1U);
  EXPECT_EQ(transforms[0].parent, "base");
  EXPECT_EQ(transforms[0].child, "lidar");
  EXPECT_THAT(transforms[0].parent_from_child.translation,
              EigenNear(base_from_lidar.translation, 1e-12));
  EXPECT_LT(RotationDistance(transforms[0].parent_from_child, base_from_lidar), 1e-12);
}

}  // namespace
}  // namespace rgbdt
