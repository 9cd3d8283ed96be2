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
  ASSERT_EQ(a.groups.size(), b.groups.size());
  for (std::size_t i = 0; i < a.groups.size(); ++i) {
    EXPECT_EQ(a.groups[i].ring, b.groups[i].ring);
    EXPECT_EQ(a.groups[i].log2_intensity, b.groups[i].log2_intensity);
    EXPECT_EQ(a.groups[i].scatter, b.groups[i].scatter);
  }
  EXPECT_EQ(a.group_sigma_m, b.group_sigma_m);
  EXPECT_EQ(a.camera, b.camera);
}

void ExpectSame(const ImageDetection& a, const ImageDetection& b) {
  EXPECT_EQ(a.camera, b.camera);
  EXPECT_EQ(a.utime, b.utime);
  EXPECT_EQ(a.why_not, b.why_not);
  EXPECT_EQ(a.detect_s, b.detect_s);
  ASSERT_EQ(a.edges.has_value(), b.edges.has_value());
  if (a.edges) ExpectSame(*a.edges, *b.edges);
}

void ExpectSame(const ViewDetection& a, const ViewDetection& b) {
  EXPECT_EQ(a.view, b.view);
  EXPECT_EQ(a.seq, b.seq);
  EXPECT_EQ(a.sweep_utime, b.sweep_utime);
  EXPECT_EQ(a.heldout, b.heldout);
  EXPECT_EQ(a.cloud.why_not, b.cloud.why_not);
  EXPECT_EQ(a.cloud.detect_s, b.cloud.detect_s);
  ASSERT_EQ(a.images.size(), b.images.size());
  for (std::size_t i = 0; i < a.images.size(); ++i) ExpectSame(a.images[i], b.images[i]);
  ASSERT_EQ(a.cloud.candidates.size(), b.cloud.candidates.size());
  for (std::size_t i = 0; i < a.cloud.candidates.size(); ++i) {
    ExpectSame(a.cloud.candidates[i], b.cloud.candidates[i]);
  }
}

constexpr int kDetectionRounds = 100;

class DetectionOnTheWire : public ::testing::Test {
 protected:
  /// One image and two candidates, with all that they may hold.
  ViewDetection Whole() {
    ViewDetection detection = random_.Seen();
    ImageDetection image = random_.InImage();
    image.edges = random_.Edges();
    image.edges->edge_pixels = {{3, 4}};
    image.edges->pose = random_.PoseOfTarget();
    image.why_not = "";
    detection.images = {image};
    CloudEdges board = random_.Boundary();
    board.pose = random_.PoseOfTarget();
    board.crossings.assign(2, random_.WhereAScanLeaves());
    board.groups.assign(2, random_.Group());
    detection.cloud.candidates.assign(2, board);
    detection.cloud.why_not = "";
    return detection;
  }

  template <typename Change>
  std::string Error(const Change& change) {
    return ErrorAfter<view_detection_t>(Whole(), change);
  }

  RandomMessages random_{3};
};

TEST_F(DetectionOnTheWire, ComesBackWhole) {
  for (int round = 0; round < kDetectionRounds; ++round) {
    const ViewDetection a = random_.Seen();
    ASSERT_NO_FATAL_FAILURE(ExpectSame(a, ThroughTheWire(a)));
  }
}

// A sweep that sees the board with a thousand lines of two crossings, four times; two cameras.
TEST_F(DetectionOnTheWire, OfADenseSweepFitsTheBus) {
  ViewDetection dense = Whole();
  dense.images[0].edges->edge_pixels = random_.Rows<Eigen::Vector2i>(20'000, 0, 99);
  dense.images.push_back(dense.images[0]);
  CloudEdges& board = dense.cloud.candidates[0];
  board.boundary = random_.Rows<Eigen::Vector3d>(2000);
  board.crossings.assign(2000, random_.WhereAScanLeaves());
  dense.cloud.candidates.assign(4, CloudEdges(board));
  EXPECT_LT(Encode(dense).size(), 1'000'000U);
  EXPECT_EQ(ThroughTheWire(dense).cloud.candidates.size(), 4U);
}

TEST_F(DetectionOnTheWire, TellsTheTimeOfItsNewestPart) {
  ViewDetection detection = Whole();
  detection.sweep_utime = 7;
  detection.images.push_back(detection.images[0]);
  detection.images[1].utime = detection.images[0].utime + 5;
  EXPECT_EQ(UtimeOf(detection), detection.images[1].utime);
  detection.images.clear();
  EXPECT_EQ(UtimeOf(detection), 7);
}

TEST_F(DetectionOnTheWire, BadFields) {
  const auto error = [&](auto change) { return Error(change); };
  EXPECT_EQ(error([](auto&) {}), "no error");
  EXPECT_THAT(error([](auto& w) { w.view = "../../etc"; }), HasSubstr("view is"));
  EXPECT_THAT(error([](auto& w) { w.image[0].image_width = 3; }), HasSubstr("edge_pixel x is 3"));
  EXPECT_THAT(error([](auto& w) { w.candidate[0].normal[0] = 2; }),
              HasSubstr("candidate[0]: length of normal"));
  EXPECT_THAT(error([](auto& w) { w.image[0].outline_corner_px[2][1] = NAN; }),
              HasSubstr("outline_corner_px[5] is nan"));
  EXPECT_THAT(error([](auto& w) {
                w.image[0].num_corners = 1, w.image[0].corner_px = {{1, NAN}};
              }),
              HasSubstr("corner_px[1] is nan"));
  EXPECT_THAT(error([](auto& w) {
                w.image[0].num_corners = 1, w.image[0].corner_px = {{INFINITY, 1}};
              }),
              HasSubstr("corner_px[0] is inf"));
  EXPECT_THAT(error([](auto& w) { w.image[0].has_edges = 0; }), HasSubstr("image[0]: why_not is"));
  EXPECT_THAT(error([](auto& w) { w.num_candidates = 0, w.candidate.clear(); }),
              HasSubstr("cloud_why_not is"));
  EXPECT_THAT(error([](auto& w) { w.cloud_why_not = "\xff"; }), HasSubstr("cloud_why_not is"));
  EXPECT_THAT(error([](auto& w) { w.image[0].why_not = "\xff"; }), HasSubstr("why_not is"));
  EXPECT_THAT(error([](auto& w) { w.image[0].camera = "../x"; }), HasSubstr("camera is"));
  EXPECT_THAT(error([](auto& w) { w.candidate[0].camera = "../x"; }), HasSubstr("camera is"));
  EXPECT_THAT(error([](auto& w) { w.cloud_detect_s = -1; }), HasSubstr("cloud_detect_s is -1"));
  EXPECT_THAT(error([](auto& w) { w.num_images = 33, w.image.resize(33, w.image[0]); }),
              HasSubstr("num_images is 33"));
}

TEST_F(DetectionOnTheWire, CornersThatWereNotSeenStayUnseen) {
  ViewDetection detection = Whole();
  detection.images[0].edges->corners = {{1.5, 2.5}, UnseenCorner(), {3.5, 4.5}};
  const std::vector<Eigen::Vector2d> sent = detection.images[0].edges->corners;
  const std::vector<Eigen::Vector2d> corners = ThroughTheWire(detection).images[0].edges->corners;
  ASSERT_EQ(corners.size(), 3U);
  EXPECT_EQ(corners[0], sent[0]);
  EXPECT_FALSE(IsSeen(corners[1]));
  EXPECT_EQ(corners[2], sent[2]);
}

TEST_F(DetectionOnTheWire, BadPoses) {
  const auto error = [&](auto change) { return Error(change); };
  EXPECT_EQ(error([](auto&) {}), "no error");
  EXPECT_THAT(error([](auto& w) { w.image[0].pose.quaternion_wxyz[0] += 0.1; }),
              HasSubstr("image[0]: pose: norm of quaternion_wxyz"));
  EXPECT_THAT(error([](auto& w) { w.candidate[0].pose.quaternion_wxyz[3] = NAN; }),
              HasSubstr("candidate[0]: pose: quaternion_wxyz[3] is nan"));
  EXPECT_THAT(error([](auto& w) { w.image[0].pose.translation_m[1] = INFINITY; }),
              HasSubstr("image[0]: pose: translation_m[1] is inf"));
  EXPECT_THAT(error([](auto& w) { w.candidate[0].pose.covariance[2][1] = NAN; }),
              HasSubstr("candidate[0]: pose: covariance[13] is nan"));
  EXPECT_THAT(error([](auto& w) { w.image[0].pose.covariance[5][5] = -1e-9; }),
              HasSubstr("image[0]: pose: diagonal of covariance is -1e-09"));
  EXPECT_THAT(error([](auto& w) { w.image[0].pose.covariance[4][0] += 1; }),
              HasSubstr("image[0]: pose: asymmetry of covariance is 1"));
  EXPECT_THAT(error([](auto& w) { w.candidate[1].pose.translation_m[0] = NAN; }),
              HasSubstr("candidate[1]: pose: translation_m[0] is nan"));
  // What is not there is not read.
  EXPECT_EQ(error([](auto& w) { w.image[0].has_pose = 0, w.image[0].pose.translation_m[1] = NAN; }),
            "no error");
  EXPECT_EQ(error([](auto& w) {
              w.candidate[0].has_pose = 0, w.candidate[0].pose.translation_m[1] = NAN;
            }),
            "no error");
}

TEST_F(DetectionOnTheWire, BadSides) {
  const auto error = [&](auto change) { return Error(change); };
  EXPECT_THAT(error([](auto& w) { w.image[0].corner_sigma_px = -1; }),
              HasSubstr("corner_sigma_px is -1"));
  EXPECT_THAT(error([](auto& w) { w.image[0].corner_sigma_px = NAN; }),
              HasSubstr("corner_sigma_px is nan"));
  EXPECT_THAT(error([](auto& w) { w.image[0].side[2].why = "\x1b"; }),
              HasSubstr("side[2]: why is"));
  EXPECT_THAT(error([](auto& w) {
                w.image[0].side[3].num_curve = 1, w.image[0].side[3].curve_px = {{1, NAN}};
              }),
              HasSubstr("side[3]: curve_px[1] is nan"));
  EXPECT_THAT(error([](auto& w) {
                w.image[0].side[0].seen = 1, w.image[0].side[0].num_curve = 1,
                w.image[0].side[0].curve_px = {{1, 2}};
              }),
              HasSubstr("side[0]: num_curve is 1; expected 2 or more"));
  EXPECT_THAT(error([](auto& w) { w.image[0].side[1].covariance_px2[1][1] = -1; }),
              HasSubstr("side[1]: diagonal of covariance_px2 is -1"));
  EXPECT_THAT(error([](auto& w) { w.image[0].side[1].covariance_px2[0][1] += 1; }),
              HasSubstr("side[1]: asymmetry of covariance_px2 is 1"));
}

TEST_F(DetectionOnTheWire, BadCrossingsAndCandidates) {
  const auto error = [&](auto change) { return Error(change); };
  EXPECT_THAT(error([](auto& w) { w.candidate[0].crossing[1].point_m[2] = NAN; }),
              HasSubstr("candidate[0]: crossing[1]: point_m[2] is nan"));
  EXPECT_THAT(error([](auto& w) { w.candidate[0].crossing[0].half_width_m = -0.1; }),
              HasSubstr("half_width_m is -0.1"));
  EXPECT_THAT(error([](auto& w) { w.candidate[0].crossing[0].side = 4; }), HasSubstr("side is 4"));
  EXPECT_THAT(error([](auto& w) { w.candidate[0].crossing[0].side = -1; }),
              HasSubstr("side is -1"));
  EXPECT_THAT(error([](auto& w) { w.candidate[0].crossing[0].kind = 0; }), HasSubstr("kind is 0"));
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

TEST_F(DetectionOnTheWire, BadScatters) {
  const auto error = [&](auto change) { return Error(change); };
  EXPECT_THAT(error([](auto& w) { w.candidate[0].crossing[1].sigma_m = -0.1; }),
              HasSubstr("candidate[0]: crossing[1]: sigma_m is -0.1"));
  EXPECT_THAT(error([](auto& w) { w.candidate[0].crossing[0].sigma_m = INFINITY; }),
              HasSubstr("candidate[0]: crossing[0]: sigma_m is inf"));
  EXPECT_THAT(error([](auto& w) { w.candidate[0].scatter[2][1] = NAN; }),
              HasSubstr("candidate[0]: scatter[9] is nan"));
  EXPECT_THAT(error([](auto& w) { w.candidate[0].raw_scatter[1][2] = NAN; }),
              HasSubstr("candidate[0]: raw_scatter[6] is nan"));
  EXPECT_THAT(error([](auto& w) { w.candidate[0].scatter[0][0] = -2; }),
              HasSubstr("candidate[0]: diagonal of scatter is -2"));
  EXPECT_THAT(error([](auto& w) { w.candidate[0].scatter[3][3] = -1; }),
              HasSubstr("candidate[0]: diagonal of scatter is -1"));
  EXPECT_THAT(error([](auto& w) { w.candidate[0].scatter[3][0] = 1e3; }),
              HasSubstr("candidate[0]: asymmetry of scatter is"));
  EXPECT_THAT(error([](auto& w) { w.candidate[0].scatter_sigma_m = NAN; }),
              HasSubstr("candidate[0]: scatter_sigma_m is nan"));
  EXPECT_THAT(error([](auto& w) { w.candidate[1].scatter_sigma_m = -1; }),
              HasSubstr("candidate[1]: scatter_sigma_m is -1"));
  EXPECT_THAT(error([](auto& w) { w.candidate[0].scatter[1][1] = INFINITY; }),
              HasSubstr("candidate[0]: scatter[5] is inf"));
  EXPECT_THAT(error([](auto& w) { w.candidate[0].group[0].ring = 256; }),
              HasSubstr("candidate[0]: group[0]: ring is 256"));
  EXPECT_THAT(error([](auto& w) { w.candidate[0].group[0].ring = -2; }),
              HasSubstr("candidate[0]: group[0]: ring is -2"));
  EXPECT_THAT(error([](auto& w) { w.candidate[0].group[1].log2_intensity = NAN; }),
              HasSubstr("candidate[0]: group[1]: log2_intensity is nan"));
  EXPECT_THAT(error([](auto& w) { w.candidate[0].group[1].log2_intensity = 1; }),
              HasSubstr("candidate[0]: group[1]: log2_intensity is 1"));
  EXPECT_THAT(error([](auto& w) { w.candidate[0].group[0].scatter[3][3] = -1; }),
              HasSubstr("candidate[0]: group[0]: diagonal of scatter is -1"));
  EXPECT_THAT(error([](auto& w) { w.candidate[0].group_sigma_m = -1; }),
              HasSubstr("candidate[0]: group_sigma_m is -1"));
  // What is not there is not read.
  EXPECT_EQ(error([](auto& w) {
              w.image[0].has_edges = 0;
              w.image[0].why_not = "no board in view";
              w.image[0].corner_sigma_px = NAN;
            }),
            "no error");
}

TEST_F(DetectionOnTheWire, ASideThatNoByteHoldsIsRefusedWhereItWasMade) {
  ViewDetection detection = Whole();
  detection.cloud.candidates[0].crossings[0].side = 256;
  EXPECT_THAT(ErrorOf([&] { Encode(detection); }), HasSubstr("side is 256"));
}

}  // namespace
}  // namespace rgbdt
