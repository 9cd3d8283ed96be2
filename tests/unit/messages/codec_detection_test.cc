#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "services/messages/codec.h"
#include "services/messages/internal/codec_types.h"
#include "tests/unit/messages/codec_testing.h"
#include "tests/unit/messages/random_messages.h"

namespace rgbdt {
namespace {

using testing::ErrorAfter;
using testing::ErrorOf;
using testing::ExpectSameRigid;
using ::testing::HasSubstr;
using testing::RandomMessages;
using testing::ThroughTheWire;

void ExpectSamePose(const std::optional<TargetPose>& a, const std::optional<TargetPose>& b) {
  ASSERT_EQ(a.has_value(), b.has_value());
  if (!a) return;
  ExpectSameRigid(a->sensor_from_target, b->sensor_from_target);
  EXPECT_EQ(a->covariance, b->covariance);
  EXPECT_EQ(a->half_turn_known, b->half_turn_known);
}

void ExpectSameSide(const ImageSide& a, const ImageSide& b) {
  EXPECT_EQ(a.seen, b.seen);
  EXPECT_EQ(a.why, b.why);
  EXPECT_EQ(a.curve, b.curve);
  EXPECT_EQ(a.covariance, b.covariance);
}

void ExpectSame(const ImageEdges& a, const ImageEdges& b) {
  EXPECT_EQ(a.width, b.width);
  EXPECT_EQ(a.height, b.height);
  EXPECT_EQ(a.picked, b.picked);
  EXPECT_EQ(a.corners, b.corners);
  EXPECT_EQ(a.outline_corners, b.outline_corners);
  EXPECT_EQ(a.edge_pixels, b.edge_pixels);
  EXPECT_EQ(a.outline, b.outline);
  EXPECT_EQ(a.corner_sigma_px, b.corner_sigma_px);
  ExpectSamePose(a.pose, b.pose);
  for (std::size_t i = 0; i < 4; ++i) ExpectSameSide(a.sides[i], b.sides[i]);
}

void ExpectSame(const CloudEdges& a, const CloudEdges& b) {
  EXPECT_EQ(a.boundary, b.boundary);
  EXPECT_EQ(a.centre, b.centre);
  EXPECT_EQ(a.normal, b.normal);
  EXPECT_EQ(a.width_m, b.width_m);
  EXPECT_EQ(a.height_m, b.height_m);
  EXPECT_EQ(a.spacing_m, b.spacing_m);
  EXPECT_EQ(a.points, b.points);
  ExpectSamePose(a.pose, b.pose);
  ASSERT_EQ(a.crossings.size(), b.crossings.size());
  for (std::size_t i = 0; i < a.crossings.size(); ++i) {
    EXPECT_EQ(a.crossings[i].point, b.crossings[i].point);
    EXPECT_EQ(a.crossings[i].half_width_m, b.crossings[i].half_width_m);
    EXPECT_EQ(a.crossings[i].side, b.crossings[i].side);
    EXPECT_EQ(a.crossings[i].kind, b.crossings[i].kind);
    EXPECT_EQ(a.crossings[i].sigma_m, b.crossings[i].sigma_m);
  }
  EXPECT_EQ(a.scatter, b.scatter);
  EXPECT_EQ(a.raw_scatter, b.raw_scatter);
  EXPECT_EQ(a.scatter_sigma_m, b.scatter_sigma_m);
}

void ExpectSameHead(const Observation& a, const Observation& b) {
  EXPECT_EQ(a.view, b.view);
  EXPECT_EQ(a.camera, b.camera);
  EXPECT_EQ(a.seq, b.seq);
  EXPECT_EQ(a.sweep_utime, b.sweep_utime);
  EXPECT_EQ(a.image_utime, b.image_utime);
  EXPECT_EQ(a.heldout, b.heldout);
  EXPECT_EQ(a.rejected, b.rejected);
  EXPECT_EQ(a.detect_image_s, b.detect_image_s);
  EXPECT_EQ(a.detect_cloud_s, b.detect_cloud_s);
  ASSERT_EQ(a.image.has_value(), b.image.has_value());
  ASSERT_EQ(a.cloud.has_value(), b.cloud.has_value());
}

constexpr int kRounds = 100;

class ObservationOnTheWire : public ::testing::Test {
 protected:
  /// Image and cloud, with all that they may hold.
  Observation Whole() {
    Observation observation = random_.Seen();
    observation.image = random_.Edges();
    observation.image->edge_pixels = {{3, 4}};
    observation.image->pose = random_.PoseOfTarget();
    observation.cloud = random_.Boundary();
    observation.cloud->pose = random_.PoseOfTarget();
    observation.cloud->crossings.assign(2, random_.WhereAScanLeaves());
    observation.candidates.assign(2, *observation.cloud);
    observation.rejected = "";
    return observation;
  }

  template <typename Change>
  std::string Error(const Change& change) {
    return ErrorAfter<observation_v3_t>(Whole(), change);
  }

  RandomMessages random_{3};
};

TEST_F(ObservationOnTheWire, ComesBackWhole) {
  for (int round = 0; round < kRounds; ++round) {
    const Observation a = random_.Seen();
    const Observation b = ThroughTheWire(a);
    ASSERT_NO_FATAL_FAILURE(ExpectSameHead(a, b));
    if (a.image) ExpectSame(*a.image, *b.image);
    if (a.cloud) ExpectSame(*a.cloud, *b.cloud);
    ASSERT_EQ(a.candidates.size(), b.candidates.size());
    for (std::size_t i = 0; i < a.candidates.size(); ++i) {
      ExpectSame(a.candidates[i], b.candidates[i]);
    }
  }
}

// A sweep that sees the board with a thousand lines of two crossings, four times.
TEST_F(ObservationOnTheWire, OfADenseSweepFitsTheBus) {
  Observation dense = random_.Seen();
  dense.image = random_.Edges();
  dense.image->edge_pixels = random_.Rows<Eigen::Vector2i>(20'000, 0, 99);
  dense.cloud = random_.Boundary();
  dense.cloud->boundary = random_.Rows<Eigen::Vector3d>(2000);
  dense.cloud->crossings.assign(2000, random_.WhereAScanLeaves());
  dense.candidates.assign(4, *dense.cloud);
  EXPECT_LT(Encode(dense).size(), 1'000'000U);
  EXPECT_EQ(ThroughTheWire(dense).candidates.size(), 4U);
}

TEST_F(ObservationOnTheWire, BadFields) {
  const auto error = [&](auto change) { return Error(change); };
  EXPECT_EQ(error([](auto&) {}), "no error");
  EXPECT_THAT(error([](auto& w) { w.view = "../../etc"; }), HasSubstr("view is"));
  EXPECT_THAT(error([](auto& w) { w.image_width = 3; }), HasSubstr("edge_pixel x is 3"));
  EXPECT_THAT(error([](auto& w) { w.cloud.normal[0] = 2; }), HasSubstr("cloud: length of normal"));
  EXPECT_THAT(error([](auto& w) { w.outline_corner_px[2][1] = NAN; }),
              HasSubstr("outline_corner_px[5] is nan"));
  EXPECT_THAT(error([](auto& w) {
                w.num_corners = 1, w.corner_px = {{1, NAN}};
              }),
              HasSubstr("corner_px[1] is nan"));
  EXPECT_THAT(error([](auto& w) {
                w.num_corners = 1, w.corner_px = {{INFINITY, 1}};
              }),
              HasSubstr("corner_px[0] is inf"));
  EXPECT_THAT(error([](auto& w) { w.has_cloud = 0; }), HasSubstr("a reason"));
  EXPECT_THAT(error([](auto& w) { w.rejected = "\xff"; }), HasSubstr("rejected is"));
}

TEST_F(ObservationOnTheWire, CornersThatWereNotSeenStayUnseen) {
  Observation observation = Whole();
  observation.image->corners = {{1.5, 2.5}, UnseenCorner(), {3.5, 4.5}};
  const std::vector<Eigen::Vector2d> corners = ThroughTheWire(observation).image->corners;
  ASSERT_EQ(corners.size(), 3U);
  EXPECT_EQ(corners[0], observation.image->corners[0]);
  EXPECT_FALSE(IsSeen(corners[1]));
  EXPECT_EQ(corners[2], observation.image->corners[2]);
}

TEST_F(ObservationOnTheWire, BadPoses) {
  const auto error = [&](auto change) { return Error(change); };
  EXPECT_EQ(error([](auto&) {}), "no error");
  EXPECT_THAT(error([](auto& w) { w.image_pose.quaternion_wxyz[0] += 0.1; }),
              HasSubstr("image_pose: norm of quaternion_wxyz"));
  EXPECT_THAT(error([](auto& w) { w.cloud.pose.quaternion_wxyz[3] = NAN; }),
              HasSubstr("cloud: pose: quaternion_wxyz[3] is nan"));
  EXPECT_THAT(error([](auto& w) { w.image_pose.translation_m[1] = INFINITY; }),
              HasSubstr("image_pose: translation_m[1] is inf"));
  EXPECT_THAT(error([](auto& w) { w.cloud.pose.covariance[2][1] = NAN; }),
              HasSubstr("cloud: pose: covariance[13] is nan"));
  EXPECT_THAT(error([](auto& w) { w.image_pose.covariance[5][5] = -1e-9; }),
              HasSubstr("image_pose: diagonal of covariance is -1e-09"));
  EXPECT_THAT(error([](auto& w) { w.image_pose.covariance[4][0] += 1; }),
              HasSubstr("image_pose: asymmetry of covariance is 1"));
  EXPECT_THAT(error([](auto& w) { w.candidate[1].pose.translation_m[0] = NAN; }),
              HasSubstr("candidate[1]: pose: translation_m[0] is nan"));
  // What is not there is not read.
  EXPECT_EQ(error([](auto& w) { w.has_image_pose = 0, w.image_pose.translation_m[1] = NAN; }),
            "no error");
  EXPECT_EQ(error([](auto& w) { w.cloud.has_pose = 0, w.cloud.pose.translation_m[1] = NAN; }),
            "no error");
}

TEST_F(ObservationOnTheWire, BadSides) {
  const auto error = [&](auto change) { return Error(change); };
  EXPECT_THAT(error([](auto& w) { w.corner_sigma_px = -1; }), HasSubstr("corner_sigma_px is -1"));
  EXPECT_THAT(error([](auto& w) { w.corner_sigma_px = NAN; }), HasSubstr("corner_sigma_px is nan"));
  EXPECT_THAT(error([](auto& w) { w.side[2].why = "\x1b"; }), HasSubstr("side[2]: why is"));
  EXPECT_THAT(error([](auto& w) {
                w.side[3].num_curve = 1, w.side[3].curve_px = {{1, NAN}};
              }),
              HasSubstr("side[3]: curve_px[1] is nan"));
  EXPECT_THAT(error([](auto& w) {
                w.side[0].seen = 1, w.side[0].num_curve = 1, w.side[0].curve_px = {{1, 2}};
              }),
              HasSubstr("side[0]: num_curve is 1; expected 2 or more"));
  EXPECT_THAT(error([](auto& w) { w.side[1].covariance_px2[1][1] = -1; }),
              HasSubstr("side[1]: diagonal of covariance_px2 is -1"));
  EXPECT_THAT(error([](auto& w) { w.side[1].covariance_px2[0][1] += 1; }),
              HasSubstr("side[1]: asymmetry of covariance_px2 is 1"));
}

TEST_F(ObservationOnTheWire, BadCrossingsAndCandidates) {
  const auto error = [&](auto change) { return Error(change); };
  EXPECT_THAT(error([](auto& w) { w.cloud.crossing[1].point_m[2] = NAN; }),
              HasSubstr("cloud: crossing[1]: point_m[2] is nan"));
  EXPECT_THAT(error([](auto& w) { w.cloud.crossing[0].half_width_m = -0.1; }),
              HasSubstr("half_width_m is -0.1"));
  EXPECT_THAT(error([](auto& w) { w.cloud.crossing[0].side = 4; }), HasSubstr("side is 4"));
  EXPECT_THAT(error([](auto& w) { w.cloud.crossing[0].side = -1; }), HasSubstr("side is -1"));
  EXPECT_THAT(error([](auto& w) { w.cloud.crossing[0].kind = 0; }), HasSubstr("kind is 0"));
  EXPECT_THAT(error([](auto& w) { w.candidate[1].crossing[0].kind = 4; }),
              HasSubstr("candidate[1]: crossing[0]: kind is 4"));
  EXPECT_THAT(error([](auto& w) { w.candidate[0].normal[1] = 3; }),
              HasSubstr("candidate[0]: length of normal"));
  EXPECT_THAT(error([](auto& w) { w.candidate[0].spacing_m = INFINITY; }),
              HasSubstr("candidate[0]: spacing_m is inf"));
  EXPECT_THAT(
      error([](auto& w) { w.candidate.resize(101, w.candidate[0]), w.num_candidates = 101; }),
      HasSubstr("num_candidates is 101"));
}

TEST_F(ObservationOnTheWire, BadScatters) {
  const auto error = [&](auto change) { return Error(change); };
  EXPECT_THAT(error([](auto& w) { w.cloud.crossing[1].sigma_m = -0.1; }),
              HasSubstr("cloud: crossing[1]: sigma_m is -0.1"));
  EXPECT_THAT(error([](auto& w) { w.cloud.crossing[0].sigma_m = INFINITY; }),
              HasSubstr("cloud: crossing[0]: sigma_m is inf"));
  EXPECT_THAT(error([](auto& w) { w.cloud.scatter[2][1] = NAN; }),
              HasSubstr("cloud: scatter[9] is nan"));
  EXPECT_THAT(error([](auto& w) { w.cloud.raw_scatter[1][2] = NAN; }),
              HasSubstr("cloud: raw_scatter[6] is nan"));
  EXPECT_THAT(error([](auto& w) { w.cloud.scatter[0][0] = -2; }),
              HasSubstr("cloud: diagonal of scatter is -2"));
  EXPECT_THAT(error([](auto& w) { w.cloud.scatter[3][3] = -1; }),
              HasSubstr("cloud: diagonal of scatter is -1"));
  EXPECT_THAT(error([](auto& w) { w.cloud.scatter[3][0] = 1e3; }),
              HasSubstr("cloud: asymmetry of scatter is"));
  EXPECT_THAT(error([](auto& w) { w.cloud.scatter_sigma_m = NAN; }),
              HasSubstr("cloud: scatter_sigma_m is nan"));
  EXPECT_THAT(error([](auto& w) { w.candidate[1].scatter_sigma_m = -1; }),
              HasSubstr("candidate[1]: scatter_sigma_m is -1"));
  EXPECT_THAT(error([](auto& w) { w.candidate[0].scatter[1][1] = INFINITY; }),
              HasSubstr("candidate[0]: scatter[5] is inf"));
  // What is not there is not read.
  EXPECT_EQ(error([](auto& w) {
              w.has_cloud = 0;
              w.rejected = "no board in view";
              w.cloud.scatter_sigma_m = NAN;
            }),
            "no error");
}

TEST_F(ObservationOnTheWire, ASideThatNoByteHoldsIsRefusedWhereItWasMade) {
  Observation observation = Whole();
  observation.cloud->crossings[0].side = 256;
  EXPECT_THAT(ErrorOf([&] { Encode(observation); }), HasSubstr("side is 256"));
}

}  // namespace
}  // namespace rgbdt
