#include "calib/detect/image/internal/board_sides.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calib/camera/pixels.h"
#include "calib/detect/image/internal/clipped.h"
#include "tests/unit/detect/image/painted_board.h"
#include "tests/unit/matchers.h"

namespace rgbdt {
namespace {

using ::testing::HasSubstr;

std::array<ImageSide, 4> Fit(const PaintedBoard& board, std::uint32_t seed = 1,
                             const BoardSidesOptions& options = {}) {
  const Image image = board.Paint(seed);
  return FitBoardSides(ToGrey(image), Clipped(image), Camera(board.spec()), board.target,
                       board.pose(), options);
}

// How far outwards of the rig file's outline a fitted side's two ends lie [px].
Eigen::Vector2d Displacement(const PaintedBoard& board, const ImageSide& side, std::size_t index) {
  const Camera camera(board.spec());
  const auto corners = board.target.OutlineCorners();
  const Eigen::Vector2d a = *camera.Project(board.camera_from_target() * corners[index]);
  const Eigen::Vector2d b = *camera.Project(board.camera_from_target() * corners[(index + 1) % 4]);
  const Eigen::Vector2d along = (b - a).normalized();
  const Eigen::Vector2d outwards(along.y(), -along.x());
  return {(side.curve.front() - a).dot(outwards), (side.curve.back() - b).dot(outwards)};
}

void ExpectDisplacement(const PaintedBoard& board, double across_x_px, double across_y_px,
                        double tolerance_px) {
  const auto sides = Fit(board);
  for (std::size_t i = 0; i < 4; ++i) {
    ASSERT_TRUE(sides[i].seen) << i << ": " << sides[i].why;
    const double expected = i % 2 == 0 ? across_y_px : across_x_px;
    EXPECT_THAT(Displacement(board, sides[i], i),
                EigenNear(Eigen::Vector2d(expected, expected), tolerance_px))
        << i;
  }
}

TEST(BoardSides, LieWhereTheImageHasThemNotWhereTheSizeSays) {
  PaintedBoard board;
  board.noise = 1;  // without any, rounding to whole grey values is alike all along a row
  board.wider_m = 0.003;
  board.higher_m = -0.002;
  const double x = 0.5 * board.wider_m * board.px_per_m();   // 0.5 px
  const double y = 0.5 * board.higher_m * board.px_per_m();  // -0.33 px
  for (const double black : {60.0, 200.0}) {                 // darker and brighter than behind
    board.black = black;
    for (const double turn : {0.0, 0.2, 1.7}) {
      board.turn_rad = turn;
      if (turn > 1) board.distance_m = 4;
      const double scale = board.px_per_m() / (1000.0 / 3);
      // A step of 50 under noise of 1 puts one edge to 0.08 px, 270 of them the line's ends to
      // 0.01 px; 4 of those, and a hundredth for the parabola.
      ExpectDisplacement(board, x * scale, y * scale, 0.05);
    }
    board.distance_m = 3;
  }
}

TEST(BoardSides, ASideMayBeBrighterAndDarkerThanWhatLiesBehind) {
  PaintedBoard board;
  board.noise = 1;
  board.background = [](double x, double y) { return x + y < 560 ? 20.0 : 120.0; };
  ExpectDisplacement(board, 0, 0, 0.06);
}

TEST(BoardSides, AHiddenStretchDoesNotMoveTheRest) {
  PaintedBoard board;
  board.noise = 1;
  board.wider_m = 0.003;
  board.background = [&](double x, double) { return x > 240 && x < 400 ? board.black : 140.0; };
  ExpectDisplacement(board, 0.5, 0, 0.06);
}

TEST(BoardSides, ASideThatLooksLikeItsBackgroundIsNotSeen) {
  PaintedBoard board;
  board.noise = 1;
  board.background = [&](double, double y) { return y < 230 ? board.black : 140.0; };
  const auto sides = Fit(board);
  EXPECT_FALSE(sides[0].seen);
  EXPECT_THAT(sides[0].why, HasSubstr("look alike along"));
  EXPECT_TRUE(sides[0].curve.empty());
  EXPECT_TRUE(sides[2].seen) << sides[2].why;
}

TEST(BoardSides, TextureBehindMakesNoSide) {
  PaintedBoard board;
  board.noise = 1;
  // Lines across and along that have nothing to do with the board, which is as bright as they.
  board.background = [](double x, double y) {
    return 60 + 25 * std::sin(0.9 * x + 0.3 * y) + 25 * std::sin(0.2 * x - 1.1 * y);
  };
  const auto sides = Fit(board);
  for (std::size_t i = 0; i < 4; ++i) {
    if (!sides[i].seen) continue;
    const Eigen::Vector2d off = Displacement(board, sides[i], i);
    EXPECT_LT(off.cwiseAbs().maxCoeff(), 4 * std::sqrt(sides[i].covariance.diagonal().maxCoeff()));
  }
}

TEST(BoardSides, ASaturatedBackgroundIsToldNotFitted) {
  PaintedBoard board;
  board.background = [](double, double y) { return y < 230 ? 900.0 : 110.0; };
  const auto sides = Fit(board);
  EXPECT_FALSE(sides[0].seen);
  EXPECT_THAT(sides[0].why, HasSubstr("saturated"));
  EXPECT_TRUE(sides[2].seen) << sides[2].why;
}

TEST(BoardSides, TheSquaresStrongerEdgeIsNotTaken) {
  PaintedBoard board;
  board.noise = 1;
  board.black = 60;
  board.background = [](double, double) { return 75.0; };  // white against black is eight times it
  board.target.width_m = 1.1 + 2 * 0.015;                  // a border of 5 px
  board.target.height_m = 0.8 + 2 * 0.015;
  ExpectDisplacement(board, 0, 0, 0.12);

  board.target.width_m = 1.1 + 2 * 0.007;  // of 2.3 px
  const auto sides = Fit(board);
  EXPECT_FALSE(sides[1].seen);
  EXPECT_THAT(sides[1].why, HasSubstr("border between outline and pattern is only 2.3 px"));
}

TEST(BoardSides, WhereTheBoardsThicknessMayShowNothingIsSaid) {
  PaintedBoard board;
  TargetPose pose = board.pose();
  pose.sensor_from_target = pose.sensor_from_target * RotationAbout({0, 1, 0}, 0.5);
  const Image image = board.Paint();
  const auto sides =
      FitBoardSides(ToGrey(image), Clipped(image), Camera(board.spec()), board.target, pose);
  // Turned about its y by 29 degrees one of the short sides shows 20 mm * sin(29 degrees).
  const bool right = sides[1].why.find("thickness") != std::string::npos;
  const bool left = sides[3].why.find("thickness") != std::string::npos;
  EXPECT_NE(right, left);
}

TEST(BoardSides, ASideOutsideTheImageIsNotSeen) {
  PaintedBoard board;
  board.turn_rad = 0;
  board.centre_px = {319.3, 100};
  const auto sides = Fit(board);
  EXPECT_FALSE(sides[0].seen);
  EXPECT_THAT(sides[0].why, HasSubstr("outside the image"));
  EXPECT_TRUE(sides[2].seen) << sides[2].why;
}

TEST(BoardSides, ErrorsAreAsLargeAsTheCovarianceSays) {
  Random random(5);
  double z2 = 0;
  int ends = 0;
  for (std::uint32_t trial = 0; trial < 40; ++trial) {
    PaintedBoard board;
    board.noise = 4;
    board.black = 85;  // a step of 25, 6 times the noise
    board.turn_rad = random.Uniform(-0.5, 0.5);
    board.distance_m = random.Uniform(3.2, 5);
    board.centre_px += Eigen::Vector2d(random.Uniform(-20, 20), random.Uniform(-20, 20));
    const auto sides = Fit(board, trial + 1);
    for (std::size_t i = 0; i < 4; ++i) {
      ASSERT_TRUE(sides[i].seen) << sides[i].why;
      const Eigen::Vector2d off = Displacement(board, sides[i], i);
      z2 += off.x() * off.x() / sides[i].covariance(0, 0);
      z2 += off.y() * off.y() / sides[i].covariance(1, 1);
      ends += 2;
    }
  }
  // 1 but for 320 ends' own scatter (4%) and the floor of 0.02 px, which makes it smaller.
  const double z = std::sqrt(z2 / ends);
  RecordProperty("normalised_error", std::to_string(z));
  EXPECT_GT(z, 0.6);
  EXPECT_LT(z, 1.3);
}

TEST(BoardSides, OptionsOutOfRangeAreNamed) {
  BoardSidesOptions options;
  options.min_share = 0;
  EXPECT_THAT(InputErrorOf([&] { options.Check(); }), HasSubstr("min_share"));
}

}  // namespace
}  // namespace rgbdt
