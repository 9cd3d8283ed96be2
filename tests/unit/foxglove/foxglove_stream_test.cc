#include "services/foxglove/stream/foxglove_stream.h"

#include <gmock/gmock.h>
#include <google/protobuf/descriptor.pb.h>
#include <google/protobuf/dynamic_message.h>

#include "calib/files/schema/rig_file.h"
#include "calib/model/errors.h"
#include "tests/unit/matchers.h"

namespace rgbdt {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr Utime kNow = 1'700'000'000'000'000;

const char kRig[] = R"(
name: "cart"
lidar { name: "vlp16" }
camera {
  name: "rgb" kind: COLOR width: 4 height: 2 pixel_format: BGR8
  pinhole { fx: 5 fy: 5 cx: 1.5 cy: 0.5 }
  camera_from_lidar_guess { quaternion_wxyz: [1, 0, 0, 0] translation_m: [1, 0, 0] }
}
target { squares_x: 11 squares_y: 8 square_m: 0.1 width_m: 1.2192 height_m: 0.9144 }
)";

RgbdtCloud OnePoint(Utime sweep, bool whole) {
  RgbdtCloud cloud;
  cloud.sweep_utime = sweep;
  cloud.sweep_end = true;
  cloud.whole_sweep = whole;
  cloud.points = {{1, 0, 0}};
  cloud.intensity = cloud.temperature_k = cloud.temperature_sigma_k = {300};
  cloud.thermal_counts = {1};
  cloud.utime = {sweep};
  cloud.rgb = {{1, 2, 3}};
  cloud.valid = {1};
  return cloud;
}

class Streaming : public testing::Test {
 protected:
  std::vector<std::string> Topics() const {
    std::vector<std::string> topics;
    for (const FoxgloveMessage& message : got_) {
      topics.push_back(message.topic + " " + message.holds_for);
    }
    return topics;
  }
  template <typename M>
  static M Parsed(const FoxgloveMessage& message) {
    M parsed;
    EXPECT_EQ(message.schema, M::descriptor());
    EXPECT_TRUE(parsed.ParseFromString(message.serialize()));
    return parsed;
  }

  std::vector<FoxgloveMessage> got_;
  FoxgloveStream stream_{{}, [this](FoxgloveMessage message) { got_.push_back(message); }};
};

TEST_F(Streaming, RigAndCalibrationHoldForTheirCamera) {
  const RigText rig{kNow, HashOfRigText(kRig), kRig};
  stream_.Take(rig);
  EXPECT_THAT(Topics(), ElementsAre("/rgb/camera_info rgb", "/tf_static rgb"));
  CalibrationMessage solved;
  solved.utime = kNow + 5;
  solved.rig_hash = rig.hash;
  solved.calibration.camera = "rgb";
  solved.calibration.camera_from_lidar.translation = {0, 2, 0};
  solved.calibration.status = SolveStatus::kConverged;
  got_.clear();
  stream_.Take(solved);
  stream_.Take(rig);
  EXPECT_THAT(Topics(), ElementsAre("/tf_static rgb", "/rgb/camera_info rgb")) << "no guess again";
  const auto transform = Parsed<foxglove::FrameTransforms>(got_[0]).transforms(0);
  EXPECT_EQ(transform.parent_frame_id(), "vlp16");
  EXPECT_EQ(transform.child_frame_id(), "rgb_optical_frame");
  EXPECT_EQ(transform.translation().y(), -2);
}

TEST_F(Streaming, OfFusedCloudsTheFirstPartsThenWholeSweepsAlone) {
  stream_.Take(OnePoint(kNow, false));
  stream_.Take(OnePoint(kNow, true));
  stream_.Take(OnePoint(kNow + 100, false));
  stream_.Take(OnePoint(kNow + 100, true));
  EXPECT_THAT(Topics(), ElementsAre("/fused/points ", "/fused/points ", "/fused/points "));
  EXPECT_TRUE(got_[0].large);
  EXPECT_EQ(got_[2].log, kNow + 100);
}

TEST_F(Streaming, WhatIsLargeIsMadeLaterOfWhatItWasThen) {
  RgbdtCloud cloud = OnePoint(kNow, true);
  stream_.Take(cloud);
  cloud.points[0].x() = 7;
  float x = 0;
  std::memcpy(&x, Parsed<foxglove::PointCloud>(got_.at(0)).data().data(), sizeof(x));
  EXPECT_EQ(x, 1);
}

TEST_F(Streaming, ACalibrationOfAnotherRigIsRefused) {
  stream_.Take(RigText{kNow, HashOfRigText(kRig), kRig});
  got_.clear();
  CalibrationMessage other;
  other.rig_hash = HashOfRigText("another");
  EXPECT_THROW(stream_.Take(other), InputError);
  EXPECT_THAT(got_, IsEmpty());
}

// As who knows nothing of these types reads them.
TEST_F(Streaming, ASchemaIsCompleteInItself) {
  google::protobuf::FileDescriptorSet set;
  ASSERT_TRUE(set.ParseFromString(DescribeSchema(*foxglove::PointCloud::descriptor())));
  google::protobuf::DescriptorPool pool;
  for (const auto& file : set.file()) ASSERT_NE(pool.BuildFile(file), nullptr) << file.name();
  EXPECT_NE(pool.FindMessageTypeByName("foxglove.PointCloud"), nullptr);
}

}  // namespace
}  // namespace rgbdt
