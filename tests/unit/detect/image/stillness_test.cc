#include "calib/detect/image/stillness.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calib/camera/pixels.h"
#include "tests/unit/detect/image/covered_board.h"
#include "tests/unit/detect/image/posed_board.h"

namespace rgbdt {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

// Thermal: its pixels are the coarser ones and its noise the worse. 3 m away a pixel is 5.7 mm.
class Stillness : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { board_ = new PosedBoard(simulate::DefaultThermalCamera()); }
  static void TearDownTestSuite() {
    delete board_;
    board_ = nullptr;
  }

  static Rigid3 Pose() {
    Rigid3 pose = RotationAbout({0.3, 1, 0}, 0.35) * RotationAbout({0, 0, 1}, 0.2);
    pose.translation = {-0.2, 0.1, 3};
    return pose;
  }

  static Rigid3 Moved(double x_m, double z_m = 0) {
    Rigid3 pose = Pose();
    pose.translation += Eigen::Vector3d(x_m, 0, z_m);
    return pose;
  }

  static cv::Mat Grey(const Rigid3& pose, int shot) {
    board_->Show(pose);
    return ToGrey(board_->Take(shot));
  }

  // As detection gives them, a few hundredths of a pixel off the truth.
  static std::vector<Eigen::Vector2d> Corners() {
    const Camera camera(board_->spec());
    std::vector<Eigen::Vector2d> corners;
    for (const Eigen::Vector3d& point : board_->target().InnerCorners()) {
      corners.push_back(*camera.Project(Pose() * point));
    }
    return corners;
  }

  static std::string Why(const cv::Mat& at_capture, const std::vector<SweepImage>& others) {
    return WhyNotStill(Camera(board_->spec()), board_->target(), at_capture, Corners(), others);
  }

  static PosedBoard* board_;
};

PosedBoard* Stillness::board_ = nullptr;

TEST_F(Stillness, NoiseIsNoMovement) {
  const cv::Mat at_capture = Grey(Pose(), 0);
  std::vector<SweepImage> others;
  for (int shot = 1; shot <= 20; ++shot) others.push_back({ToGrey(board_->Take(shot)), 0.6 * shot});
  EXPECT_THAT(Why(at_capture, others), IsEmpty());
}

TEST_F(Stillness, NeitherIsAThirdOfAPixel) {
  EXPECT_THAT(Why(Grey(Pose(), 0), {{Grey(Moved(0.0019), 1), 6.0}}), IsEmpty());
}

TEST_F(Stillness, APixelIsToldWithItsMillimetresAndItsTime) {
  const std::string why =
      Why(Grey(Pose(), 0), {{Grey(Pose(), 1), 0.4}, {Grey(Moved(0.0057), 2), 6.2}});
  EXPECT_THAT(why, HasSubstr("moved 6 mm"));
  EXPECT_THAT(why, HasSubstr("1.0 px"));
  EXPECT_THAT(why, HasSubstr("6.2 s"));
}

TEST_F(Stillness, ASlowDriftIsToldOnceItIsTooFar) {
  std::vector<SweepImage> others;
  for (int i = 1; i <= 6; ++i) others.push_back({Grey(Moved(0.0011 * i), i), 2.0 * i});
  // 0.19 px an image: the third is at 0.58 px.
  EXPECT_THAT(Why(Grey(Pose(), 0), others), HasSubstr("6.0 s"));
}

TEST_F(Stillness, AwayFromTheCameraIsAMovementToo) {
  // The corners move by 1% of their distance from the middle of what is seen.
  EXPECT_THAT(Why(Grey(Pose(), 0), {{Grey(Moved(0, 0.06), 1), 6.0}}), HasSubstr("board moved"));
}

TEST_F(Stillness, ATurnInPlaceIsAMovementToo) {
  const Rigid3 turned = Pose() * RotationAbout({0, 0, 1}, 0.015);
  EXPECT_THAT(Why(Grey(Pose(), 0), {{Grey(turned, 1), 6.0}}), HasSubstr("board moved"));
}

TEST_F(Stillness, AJumpIsAMovement) {
  EXPECT_THAT(Why(Grey(Pose(), 0), {{Grey(Moved(0.17), 1), 6.0}}), HasSubstr("board moved"));
}

// The pattern is like itself two squares farther on: inner corners alone would not tell. In colour
// and near by, where what moved is too far away for the tracker.
TEST(StillnessInColour, ShiftedByTwoSquaresIsAMovement) {
  PosedBoard board(simulate::DefaultColorCamera());
  const Camera camera(board.spec());
  Rigid3 pose = RotationAbout({0.3, 1, 0}, 0.1) * RotationAbout({0, 0, 1}, 0.5);
  pose.translation = {-0.2, 0.1, 2.5};
  std::vector<Eigen::Vector2d> corners;
  for (const Eigen::Vector3d& point : board.target().InnerCorners()) {
    corners.push_back(*camera.Project(pose * point));
  }
  board.Show(pose);
  const cv::Mat at_capture = ToGrey(board.Take(0));
  const cv::Mat again = ToGrey(board.Take(1));
  EXPECT_THAT(WhyNotStill(camera, board.target(), at_capture, corners, {{again, 3.0}}), IsEmpty());
  Rigid3 moved = pose;
  moved.translation += pose.rotation * Eigen::Vector3d(0.2, 0, 0);
  board.Show(moved);
  const cv::Mat later = ToGrey(board.Take(2));
  EXPECT_THAT(WhyNotStill(camera, board.target(), at_capture, corners, {{later, 6.0}}),
              HasSubstr("moved"));
}

TEST_F(Stillness, CornersThatWereNotSeenSayNothing) {
  const Camera camera(board_->spec());
  Random random(1);
  const auto covered = [&](const Rigid3& pose, int shot, double aside) {
    board_->Show(pose);
    Image image = board_->Take(shot);
    PaintCover(camera, board_->target(), pose, Cover::kPerson, aside, &random, &image.pixels);
    return ToGrey(image);
  };
  std::vector<Eigen::Vector2d> corners = Corners();
  const auto points = board_->target().InnerCorners();
  for (std::size_t i = 0; i < points.size(); ++i) {  // a person stands before the middle
    if (std::abs(points[i].x()) < 0.3) corners[i] = UnseenCorner();
  }
  const cv::Mat at_capture = covered(Pose(), 0, 0);
  const auto why = [&](const cv::Mat& other) {
    return WhyNotStill(camera, board_->target(), at_capture, corners, {{other, 3.0}});
  };
  EXPECT_THAT(why(covered(Pose(), 1, 0)), IsEmpty());
  EXPECT_THAT(why(covered(Pose(), 2, 0.12)), IsEmpty()) << "who hides it may walk, not the board";
  EXPECT_THAT(why(covered(Moved(0.0057), 3, 0)), HasSubstr("board moved 6 mm"));
  EXPECT_THAT(why(covered(Moved(0.0057), 4, 0.12)), HasSubstr("board moved"));
  Rigid3 behind = Pose();
  behind.translation = {0, 0, -3};
  EXPECT_THAT(why(Grey(behind, 5)), HasSubstr("not found again"));
}

// As a person's picks leave them: corners close to what hides the others are still seen.
TEST_F(Stillness, WhatHidesTheBoardMayReachIntoTheCornersBesideIt) {
  const Camera camera(board_->spec());
  const Target target = board_->target();
  const auto covered = [&](const Rigid3& pose, int shot) {
    Random random(1);
    board_->Show(pose);
    Image image = board_->Take(shot);
    PaintCover(camera, target, Pose(), Cover::kBar, 0, &random, &image.pixels);
    return ToGrey(image);
  };
  std::vector<Eigen::Vector2d> corners = Corners();
  const auto points = target.InnerCorners();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool hidden =
        Hides(Cover::kBar, 0, points[i].x() / target.width_m, points[i].y() / target.height_m);
    if (hidden) corners[i] = UnseenCorner();
  }
  const cv::Mat at_capture = covered(Pose(), 0);
  const auto why = [&](const cv::Mat& other) {
    return WhyNotStill(camera, target, at_capture, corners, {{other, 3.0}});
  };
  EXPECT_THAT(why(covered(Pose(), 1)), IsEmpty());
  EXPECT_THAT(why(covered(Moved(0.0057), 2)), HasSubstr("board moved"));
}

TEST_F(Stillness, ABoardThatIsGoneIsToldSo) {
  const cv::Mat at_capture = Grey(Pose(), 0);
  Rigid3 behind = Pose();
  behind.translation = {0, 0, -3};
  EXPECT_THAT(Why(at_capture, {{Grey(behind, 1), 3.0}}),
              HasSubstr("not found again in the image 3.0 s"));
}

}  // namespace
}  // namespace rgbdt
