// Boards whose markers tell which part of them is seen.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/core.hpp>

#include "calib/detect/image/checkerboard.h"
#include "calib/detect/image/image_edges.h"
#include "tests/unit/detect/image/corner_errors.h"
#include "tests/unit/detect/image/marked_scene.h"
#include "tests/unit/matchers.h"

namespace rgbdt {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::ptrdiff_t SeenOf(const std::vector<Eigen::Vector2d>& corners) {
  return std::count_if(corners.begin(), corners.end(), IsSeen);
}

const MarkedScene& Charuco() {
  static const MarkedScene scene = RenderMarked(CharucoBoard(), 1);
  return scene;
}

TEST(MarkedBoard, CharucoIsFoundInItsOwnOrder) {
  const CheckerboardResult result = FindCheckerboard(Charuco().grey(), Charuco().target);
  ASSERT_TRUE(result.board.has_value()) << result.why;
  EXPECT_TRUE(result.board->order_known);
  EXPECT_TRUE(result.board->top_left_dark);
  const auto count = static_cast<std::ptrdiff_t>(Charuco().corners.size());
  EXPECT_GE(SeenOf(result.board->corners), count * 9 / 10);
  const Errors errors = Compare(result.board->corners, Charuco().corners);
  EXPECT_LT(errors.worst, 0.5);
  EXPECT_LT(errors.rms, 0.1);
  EXPECT_FALSE(errors.turned);
}

TEST(MarkedBoard, CharucoIsUsedByThePartThatIsSeen) {
  MarkedScene scene = Charuco();
  HideTwoFifths(1, &scene);
  const ImageEdgesResult found =
      DetectImageEdges(scene.image, Camera(scene.spec), scene.target, nullptr, scene.spec.kind);
  ASSERT_TRUE(found.edges.has_value()) << found.why;
  const auto count = static_cast<std::ptrdiff_t>(scene.corners.size());
  EXPECT_GE(SeenOf(found.edges->corners), count * 2 / 5);
  EXPECT_LE(SeenOf(found.edges->corners), count * 2 / 3);
  EXPECT_LT(Compare(found.edges->corners, scene.corners).worst, 0.5);
  ASSERT_TRUE(found.edges->pose.has_value());
  EXPECT_TRUE(found.edges->pose->half_turn_known);
  EXPECT_THAT(found.edges->pose->sensor_from_target.translation,
              EigenNear(scene.camera_from_target.translation, 0.02));
}

// An even number of rows begins with white where OpenCV before 4.6 drew it.
TEST(MarkedBoard, ALegacyBoardIsToldFromANewOne) {
  simulate::BoardOptions board = CharucoBoard();
  board.markers->legacy = true;
  const MarkedScene scene = RenderMarked(board, 1);
  const CheckerboardResult result = FindCheckerboard(scene.grey(), scene.target);
  ASSERT_TRUE(result.board.has_value()) << result.why;
  EXPECT_FALSE(result.board->top_left_dark);
  EXPECT_LT(Compare(result.board->corners, scene.corners).worst, 0.5);
  EXPECT_THAT(FindCheckerboard(scene.grey(), Charuco().target).why, HasSubstr("legacy: true"));
  EXPECT_THAT(FindCheckerboard(Charuco().grey(), scene.target).why,
              HasSubstr("take out legacy: true"));
}

TEST(MarkedBoard, MarkersThatStandAloneAreMeasuredAtTheirCorners) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const MarkedScene scene = RenderMarked(HolesBoard(), seed);
    ASSERT_EQ(scene.corners.size(), 16U);
    const ImageEdgesResult found =
        DetectImageEdges(scene.image, Camera(scene.spec), scene.target, nullptr, scene.spec.kind);
    ASSERT_TRUE(found.edges.has_value()) << "seed " << seed << ": " << found.why;
    EXPECT_EQ(SeenOf(found.edges->corners), 16) << "seed " << seed;
    const Errors errors = Compare(found.edges->corners, scene.corners);
    EXPECT_LT(errors.rms, 0.1) << "seed " << seed;
    EXPECT_LT(errors.worst, 0.3) << "seed " << seed;
    EXPECT_FALSE(errors.turned);
    ASSERT_TRUE(found.edges->pose.has_value());
    EXPECT_TRUE(found.edges->pose->half_turn_known);
    EXPECT_THAT(found.edges->pose->sensor_from_target.translation,
                EigenNear(scene.camera_from_target.translation, 0.02));
  }
}

// Its markers are too small for it, and as warm as the rest.
TEST(MarkedBoard, AThermalCameraFindsABoardWithHolesByItsOutline) {
  simulate::BoardOptions board = HolesBoard();
  board.black_minus_white_k = 0;
  board.hidden_outline_m = 0;
  board.temperature_k = 330;
  const MarkedScene scene = RenderMarked(board, 2, 1);
  ASSERT_EQ(scene.spec.kind, CameraKind::kThermal);
  const Camera camera(scene.spec);
  const ImageEdgesResult found =
      DetectImageEdges(scene.image, camera, scene.target, nullptr, scene.spec.kind);
  ASSERT_TRUE(found.edges.has_value()) << found.why;
  EXPECT_TRUE(found.edges->corners.empty());
  ASSERT_TRUE(found.edges->pose.has_value());
  EXPECT_FALSE(found.edges->pose->half_turn_known);
  EXPECT_THAT(found.edges->pose->sensor_from_target.translation,
              EigenNear(scene.camera_from_target.translation, 0.05));
  // A colour camera that does not see them is told so.
  const ImageEdgesResult colour =
      DetectImageEdges(scene.image, camera, scene.target, nullptr, CameraKind::kColor);
  EXPECT_FALSE(colour.edges.has_value());
}

TEST(MarkedBoard, MarkersOfAnotherBoardWithHolesAreNamed) {
  const MarkedScene scene = RenderMarked(HolesBoard(), 1);
  Target target = scene.target;
  target.holes->first_marker = 11;
  EXPECT_THAT(FindCheckerboard(scene.grey(), target).why,
              HasSubstr("markers 1 to 4 are in the image, but a board of four holes has 11 to 14"));
}

TEST(MarkedBoard, WhatIsWrongIsSaid) {
  const cv::Mat grey = Charuco().grey();
  Target target = Charuco().target;
  target.markers->family = "6X6_100";
  EXPECT_THAT(FindCheckerboard(grey, target).why,
              AllOf(HasSubstr("markers of 5X5_1000"), HasSubstr("none of 6X6_100")));
  target = Charuco().target;
  target.squares_x = 9;
  EXPECT_THAT(FindCheckerboard(grey, target).why, HasSubstr("a board of 9 x 8 squares has 0 to"));
  target.squares_x = 12;
  EXPECT_THAT(FindCheckerboard(grey, target).why, HasSubstr("with 11, not 12 in a row"));
  cv::Mat mirrored;
  cv::flip(grey, mirrored, 1);
  EXPECT_THAT(FindCheckerboard(mirrored, Charuco().target).why, HasSubstr("printed mirrored"));
  const cv::Mat empty(480, 640, CV_32F, cv::Scalar(3));
  EXPECT_FALSE(FindCheckerboard(empty, Charuco().target).board.has_value());
}

}  // namespace
}  // namespace rgbdt
