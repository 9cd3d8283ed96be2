#include "services/import/ros_messages.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "tests/unit/files/test_data.h"
#include "tests/unit/import/ros_bytes.h"
#include "tests/unit/matchers.h"

namespace rgbdt {
namespace {

using test::MessageOf;
using test::RosBytes;
using testing::HasSubstr;

struct Layout {
  BagEncoding encoding;
  bool big_endian;
};
const Layout kLayouts[] = {
    {BagEncoding::kRos1, false}, {BagEncoding::kCdr, false}, {BagEncoding::kCdr, true}};

// Frames of every length: what follows is aligned otherwise each time.
TEST(RosMessages, ImagesOfEveryLayout) {
  for (const auto& [encoding, big_endian] : kLayouts) {
    for (const std::string frame : {"", "a", "ab", "abc", "/abcd"}) {
      RosBytes bytes(encoding, big_endian);
      bytes.Header(1'700'000'000, 123'456'789, frame).Add(2U).Add(3U).Text("mono8");
      const std::string whole = bytes.Add(std::uint8_t{1}).Add(4U).Blob("12345678").Bytes();
      const ros::Image image = ros::DecodeImage(MessageOf(whole), encoding);
      EXPECT_EQ(image.header.utime, 1'700'000'000'123'456);
      EXPECT_EQ(image.header.frame, frame == "/abcd" ? "abcd" : frame);
      EXPECT_EQ(image.height, 2U);
      EXPECT_EQ(image.width, 3U);
      EXPECT_EQ(image.encoding, "mono8");
      EXPECT_TRUE(image.big_endian);
      EXPECT_EQ(image.step, 4U);
      EXPECT_EQ(std::string(image.data, image.data + image.size), "12345678");
      for (std::size_t size = 0; size < whole.size(); ++size) {
        const std::string cut = whole.substr(0, size);
        EXPECT_THROW(ros::DecodeImage(MessageOf(cut), encoding), InputError) << size;
      }
    }
  }
}

std::string CameraInfoBytes(BagEncoding encoding, bool big_endian) {
  RosBytes bytes(encoding, big_endian);
  bytes.Header(1, 0, "cam").Add(480U).Add(640U).Text("plumb_bob").Add(2U).Add(0.5).Add(-0.25);
  for (int i = 0; i < 9 + 9 + 12; ++i) bytes.Add(static_cast<double>(i));
  return bytes.Add(1U).Add(2U).Add(3U).Add(4U).Add(5U).Add(6U).Add(std::uint8_t{0}).Bytes();
}

TEST(RosMessages, CameraInfoOfEveryLayout) {
  for (const auto& [encoding, big_endian] : kLayouts) {
    const std::string bytes = CameraInfoBytes(encoding, big_endian);
    const ros::CameraInfo info = ros::DecodeCameraInfo(MessageOf(bytes), encoding);
    EXPECT_EQ(info.width, 640U);
    EXPECT_THAT(info.d, testing::ElementsAre(0.5, -0.25));
    EXPECT_EQ(info.k[8], 8);
    EXPECT_EQ(info.binning_y, 2U);
    EXPECT_EQ(info.roi_x, 3U);
  }
}

TEST(RosMessages, TransformsOfEveryLayout) {
  for (const auto& [encoding, big_endian] : kLayouts) {
    RosBytes bytes(encoding, big_endian);
    bytes.Add(1U).Header(0, 0, "/base").Text("lidar").Add(1.0).Add(2.0).Add(3.0);
    const std::string whole = bytes.Add(0.0).Add(0.0).Add(1.0).Add(0.0).Bytes();  // x y z w
    const auto transforms = ros::DecodeTransforms(MessageOf(whole), encoding);
    ASSERT_EQ(transforms.size(), 1U);
    EXPECT_EQ(transforms[0].parent, "base");
    EXPECT_EQ(transforms[0].child, "lidar");
    const Eigen::Vector3d moved = transforms[0].parent_from_child * Eigen::Vector3d(1, 0, 0);
    EXPECT_THAT(moved, EigenNear(Eigen::Vector3d(0, 2, 3), 1e-12));
  }
}

TEST(RosMessages, NoRotationIsRefused) {
  RosBytes bytes(BagEncoding::kRos1);
  bytes.Add(1U).Header(0, 0, "base").Text("lidar");
  for (int i = 0; i < 7; ++i) bytes.Add(0.0);
  const std::string whole = bytes.Bytes();
  EXPECT_THAT(test::ErrorOf([&] { ros::DecodeTransforms(MessageOf(whole), BagEncoding::kRos1); }),
              HasSubstr("lidar to base"));
}

TEST(RosMessages, CdrOfAnotherKindIsRefused) {
  const std::string bytes("\0\x07\0\0", 4);  // XCDR2
  EXPECT_THAT(test::ErrorOf([&] { ros::DecodeImage(MessageOf(bytes), BagEncoding::kCdr); }),
              HasSubstr("kind 7"));
  EXPECT_THAT(test::ErrorOf([&] { ros::DecodeImage(MessageOf(bytes), BagEncoding::kOther); }),
              HasSubstr("neither"));
}

// Lengths and counts may be anything; none is believed.
TEST(RosMessages, DamagedAnywhereAtMostThrows) {
  std::mt19937 random(1);
  for (const auto& [encoding, big_endian] : kLayouts) {
    RosBytes cloud(encoding, big_endian);
    cloud.Header(1, 0, "lidar").Add(1U).Add(2U).Add(1U).Text("x").Add(0U).Add(std::uint8_t{7});
    cloud.Add(1U).Add(std::uint8_t{0}).Add(4U).Add(8U).Blob("12345678").Add(std::uint8_t{1});
    int refused = 0;
    for (const std::string& whole : {cloud.Bytes(), CameraInfoBytes(encoding, big_endian)}) {
      for (int i = 0; i < 3000; ++i) {
        std::string damaged = whole;
        damaged[random() % damaged.size()] = static_cast<char>(random());
        damaged[random() % damaged.size()] = static_cast<char>(random());
        const auto decode = [&, encoding = encoding](auto function) {
          try {
            function(MessageOf(damaged), encoding);
          } catch (const InputError&) {
            ++refused;
          }
        };
        decode(ros::DecodePointCloud);
        decode(ros::DecodeCameraInfo);
        decode(ros::DecodeTransforms);
      }
    }
    EXPECT_GT(refused, 1000);
  }
}

std::string LivoxMessage(BagEncoding encoding, bool big_endian, std::uint32_t said,
                         std::uint32_t count) {
  RosBytes bytes(encoding, big_endian);
  bytes.Header(1'700'000'000, 0, "livox_frame").Add(std::uint64_t{1'700'000'000'000'000'000});
  bytes.Add(said).Add(std::uint8_t{1});
  for (int i = 0; i < 3; ++i) bytes.Add(std::uint8_t{0});
  bytes.Add(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    bytes.Add(1000 * i).Add(1.5F + static_cast<float>(i)).Add(-2.5F).Add(0.25F);
    bytes.Add(static_cast<std::uint8_t>(10 + i)).Add(std::uint8_t{0x10}).Add(std::uint8_t{3});
  }
  return bytes.Bytes();
}

TEST(RosMessages, ALivoxsOwnOfEveryLayout) {
  for (const auto& layout : kLayouts) {
    const BagEncoding encoding = layout.encoding;
    const bool big_endian = layout.big_endian;
    const std::string whole = LivoxMessage(encoding, big_endian, 3, 3);
    const ros::PointCloud cloud = ros::DecodeLivoxCloud(MessageOf(whole), encoding);
    EXPECT_EQ(cloud.header.utime, 1'700'000'000'000'000);
    ASSERT_EQ(cloud.width, 3U);
    ASSERT_EQ(cloud.size, 3 * 19U);
    for (std::uint32_t i = 0; i < 3; ++i) {
      std::uint32_t offset = 0;
      float place[3];
      std::memcpy(&offset, cloud.data + 19 * i, 4);
      std::memcpy(place, cloud.data + 19 * i + 4, 12);
      EXPECT_EQ(offset, 1000 * i);
      EXPECT_EQ(place[0], 1.5F + static_cast<float>(i));
      EXPECT_EQ(place[2], 0.25F);
      EXPECT_EQ(cloud.data[19 * i + 16], 10 + i);
      EXPECT_EQ(cloud.data[19 * i + 18], 3);
    }
    for (std::size_t size = 0; size < whole.size(); ++size) {
      const std::string cut = whole.substr(0, size);
      EXPECT_THROW(ros::DecodeLivoxCloud(MessageOf(cut), encoding), InputError);
    }
    const std::string lies = LivoxMessage(encoding, big_endian, 4, 3);
    EXPECT_THAT(test::ErrorOf([&] { ros::DecodeLivoxCloud(MessageOf(lies), encoding); }),
                HasSubstr("says that it has 4 points, and holds 3"));
  }
}

}  // namespace
}  // namespace rgbdt
