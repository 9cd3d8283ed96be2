#include "services/import/sensor_data.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "tests/unit/files/test_data.h"

namespace rgbdt {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr Utime kStamp = 1'700'000'000'000'000;

// Builds clouds field by field.
class RosCloud {
 public:
  RosCloud(std::uint32_t width, std::uint32_t height, std::uint32_t point_step) {
    cloud_.header.utime = kStamp;
    cloud_.width = width;
    cloud_.height = height;
    cloud_.point_step = point_step;
    cloud_.row_step = width * point_step;
    bytes_.resize(std::size_t{cloud_.row_step} * height);
  }
  template <typename T>
  RosCloud& Add(const std::string& name, std::uint32_t offset, int datatype,
                const std::vector<T>& values) {
    cloud_.fields.push_back({name, offset, static_cast<std::uint8_t>(datatype), 1});
    for (std::size_t i = 0; i < values.size(); ++i) {
      std::memcpy(&bytes_[i * cloud_.point_step + offset], &values[i], sizeof(T));
    }
    return *this;
  }
  RosCloud& AddXyz(const std::vector<float>& x) {
    return Add("x", 0, 7, x)
        .Add("y", 4, 7, std::vector<float>(x.size(), 1))
        .Add("z", 8, 7, std::vector<float>(x.size(), 2));
  }
  ros::PointCloud& Get() {
    cloud_.data = reinterpret_cast<const std::uint8_t*>(bytes_.data());
    cloud_.size = bytes_.size();
    return cloud_;
  }
  Cloud Read() { return ToCloud(Get(), "/points"); }
  std::string Error() {
    return test::ErrorOf([this] { Read(); });
  }

 private:
  ros::PointCloud cloud_;
  std::string bytes_;
};

// velodyne_pointcloud's XYZIRT: gaps, intensity to 255, time [s] before and after the header's.
TEST(RosClouds, Velodyne) {
  RosCloud cloud(3, 1, 22);
  cloud.AddXyz({1, NAN, 3})
      .Add<float>("intensity", 12, 7, {51, 0, 255})
      .Add<std::uint16_t>("ring", 16, 4, {0, 7, 15})
      .Add<float>("time", 18, 7, {-0.05F, 0, 0.01F});
  const Cloud read = cloud.Read();
  EXPECT_EQ(read.sweep_utime, kStamp);
  EXPECT_FALSE(read.organised);
  EXPECT_TRUE(read.IsHit(0));
  EXPECT_FALSE(read.IsHit(1));
  EXPECT_EQ(read.points[2], Eigen::Vector3f(3, 1, 2));
  EXPECT_THAT(read.intensity, ElementsAre(0.2F, 0, 1));
  EXPECT_THAT(read.ring, ElementsAre(0, 7, 15));
  EXPECT_THAT(read.utime, ElementsAre(kStamp - 50'000, kStamp, kStamp + 10'000));
}

// ouster_ros: organised, fields beyond, misses at 0 0 0, t [ns].
TEST(RosClouds, Ouster) {
  RosCloud cloud(2, 2, 48);
  cloud.AddXyz({1, 2, 3, 4})
      .Add<float>("intensity", 16, 7, {1000, 65535, 0, 0})
      .Add<std::uint32_t>("t", 20, 6, {0, 1'000'000, 0, 1'500'000})
      .Add<std::uint16_t>("reflectivity", 24, 4, {1, 2, 3, 4})
      .Add<std::uint8_t>("ring", 26, 2, {0, 0, 1, 1})
      .Add<std::uint32_t>("range", 32, 6, {1, 2, 3, 4});
  const Cloud read = cloud.Read();
  EXPECT_TRUE(read.organised);
  EXPECT_EQ(read.lines, 2);
  EXPECT_EQ(read.beams, 2);
  EXPECT_EQ(read.intensity[1], 1);
  EXPECT_THAT(read.ring, ElementsAre(0, 0, 1, 1));
  EXPECT_THAT(read.utime, ElementsAre(kStamp, kStamp + 1000, kStamp, kStamp + 1500));
}

// hesai_ros_driver and rslidar: timestamp [s] since 1970. livox_ros_driver2: the same in ns, and
// line.
TEST(RosClouds, HesaiAndLivox) {
  RosCloud hesai(2, 1, 32);
  hesai.AddXyz({1, 2}).Add<double>("timestamp", 16, 8, {1'700'000'000.25, 1'700'000'000.5});
  EXPECT_THAT(hesai.Read().utime, ElementsAre(kStamp + 250'000, kStamp + 500'000));
  EXPECT_THAT(hesai.Read().ring, IsEmpty());
  RosCloud livox(2, 1, 32);
  livox.AddXyz({1, 2})
      .Add<std::uint8_t>("line", 12, 2, {3, 1})
      .Add<double>("timestamp", 16, 8, {1'700'000'000'250'000'000.0, 1'700'000'000'500'000'000.0});
  EXPECT_THAT(livox.Read().utime, ElementsAre(kStamp + 250'000, kStamp + 500'000));
  EXPECT_THAT(livox.Read().ring, ElementsAre(3, 1));
}

// livox_ros_driver2's PointXYZRTLT: what its tags call noise, and what returned nothing, is left
// out.
TEST(RosClouds, ALivoxHasNoRingsAndOnlyNormalPoints) {
  RosCloud livox(5, 1, 32);
  livox.AddXyz({1, 2, 3, 4, 5})
      .Add<std::uint8_t>("tag", 12, 2, {0x00, 0x10, 0x01, 0x04, 0x20})
      .Add<std::uint8_t>("line", 13, 2, {3, 1, 0, 2, 2})
      .Add<std::uint32_t>("offset_time", 16, 6, {0, 1'000'000, 2'000'000, 3'000'000, 4'000'000});
  const Cloud read = livox.Read();
  EXPECT_THAT(read.ring, IsEmpty());
  EXPECT_FALSE(read.organised);
  EXPECT_THAT(read.utime, ElementsAre(kStamp, kStamp + 1000, kStamp + 4000));
  EXPECT_EQ(read.points[2].x(), 5);
  RosCloud noise(1, 1, 32);
  noise.AddXyz({1}).Add<std::uint8_t>("tag", 12, 2, {2}).Add<std::uint8_t>("line", 13, 2, {0});
  EXPECT_THAT(noise.Error(), HasSubstr("no points that its tags call normal"));
}

TEST(RosClouds, ReflectivityStandsForIntensity) {
  RosCloud cloud(2, 1, 16);
  cloud.AddXyz({1, 2}).Add<std::uint16_t>("reflectivity", 12, 4, {0, 255});
  EXPECT_THAT(cloud.Read().intensity, ElementsAre(0, 1));
}

TEST(RosClouds, RowsThatFillTheMessageAreWhereTheyAre) {
  for (const std::uint32_t row_step : {0U, 48U, 24U}) {
    RosCloud cloud(2, 2, 12);
    cloud.AddXyz({1, 2, 3, 4}).Get().row_step = row_step;
    const Cloud read = cloud.Read();
    EXPECT_EQ(read.lines, 2);
    EXPECT_EQ(read.points[3].x(), 4) << row_step;
  }
}

TEST(RosClouds, WhatCannotBeIsRefused) {
  EXPECT_THAT(RosCloud(0, 1, 12).AddXyz({}).Error(), HasSubstr("no points"));
  EXPECT_THAT(RosCloud(1, 1, 12).AddXyz({0}).Add<float>("t", 9, 7, {}).Error(),
              HasSubstr("\"t\" lies beyond"));
  EXPECT_THAT(RosCloud(1, 1, 16).AddXyz({0}).Add<float>("intensity", 2, 7, {}).Error(),
              HasSubstr("lies over"));
  EXPECT_THAT(RosCloud(1, 1, 16).AddXyz({0}).Add<float>("a", 12, 9, {}).Error(),
              HasSubstr("datatype 9"));
  EXPECT_THAT(RosCloud(1, 1, 8).Add<float>("x", 0, 7, {1}).Error(), HasSubstr("y"));
  RosCloud large(1, 1, 12);
  large.AddXyz({1}).Get().height = 4'000'000'000U;
  EXPECT_THAT(large.Error(), HasSubstr("cut short"));
  RosCloud big(1, 1, 12);
  big.AddXyz({1}).Get().big_endian = true;
  EXPECT_THAT(big.Error(), HasSubstr("big-endian"));
  // A name cannot become a line of the header.
  RosCloud odd(1, 1, 16);
  odd.AddXyz({1}).Add<float>("t\nDATA ascii\n", 12, 7, {1});
  EXPECT_EQ(odd.Read().size(), 1U);
}

ros::CameraInfo Info() {
  ros::CameraInfo info;
  info.width = 640;
  info.height = 480;
  info.distortion_model = "plumb_bob";
  info.k = {500.125, 0, 320.1, 0, 501, 240.3, 0, 0, 1};
  info.d = {-0.1, 0.02, 1.0 / 3, 0, 0};
  return info;
}

LensWanted Wanted(const std::string& topic) {
  LensWanted wanted;
  wanted.file = topic;
  return wanted;
}

TEST(RosLenses, CameraInfoIsReadAsItsFileIs) {
  const std::optional<FileLens> lens = ToLens(Info(), Wanted("/cam/camera_info"));
  ASSERT_TRUE(lens);
  EXPECT_EQ(lens->width, 640);
  EXPECT_EQ(lens->lens.fx, 500.125);
  EXPECT_EQ(lens->lens.distortion[2], 1.0 / 3);
  EXPECT_EQ(lens->where, "/cam/camera_info");
  ros::CameraInfo fisheye = Info();
  fisheye.distortion_model = "equidistant";
  fisheye.d.resize(4);
  EXPECT_EQ(ToLens(fisheye, Wanted("/i"))->lens.model, Lens::Model::kFisheye);
}

TEST(RosLenses, ASizeOfZeroIsNone) {
  ros::CameraInfo info = Info();
  info.width = info.height = 0;
  EXPECT_EQ(ToLens(info, Wanted("/i"))->width, 0);
}

TEST(RosLenses, WhatIsNoLensIsNone) {
  ros::CameraInfo info = Info();
  info.k = {};
  EXPECT_FALSE(ToLens(info, Wanted("/i")));
  const auto error = [](const ros::CameraInfo& bad) {
    return test::ErrorOf([&] { ToLens(bad, Wanted("/i")); });
  };
  info = Info();
  info.binning_x = 2;
  EXPECT_THAT(error(info), HasSubstr("binning 2"));
  info = Info();
  info.roi_x = 8;
  EXPECT_THAT(error(info), HasSubstr("x_offset"));
  info = Info();
  info.distortion_model = "fov: [\n";
  EXPECT_THAT(error(info), HasSubstr("fov"));
  info = Info();
  info.d[0] = NAN;
  EXPECT_THAT(error(info), HasSubstr("/i"));
}

}  // namespace
}  // namespace rgbdt
