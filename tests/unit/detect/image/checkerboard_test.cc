#include "calib/detect/image/checkerboard.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "calib/camera/pixels.h"
#include "calib/simulate/simulator.h"
#include "tests/study/image_scenes.h"
#include "tests/unit/detect/image/corner_errors.h"
#include "tests/unit/detect/image/overexposed_board.h"
#include "tests/unit/detect/image/painted_checkerboard.h"

namespace rgbdt {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

// Positive: rows run to the right of which columns go down.
double Handedness(const Checkerboard& board, const Target& target) {
  const auto wide = static_cast<std::size_t>(target.corners_x());
  return Cross(board.corners[1] - board.corners[0], board.corners[wide] - board.corners[0]);
}

// Each hard term alone, and all of them together, on rendered thermal images; and colour.
class RenderedBoard : public ::testing::TestWithParam<study::SceneClass> {};

TEST_P(RenderedBoard, IsFoundWithinAPixelAndItsPolarityIsTold) {
  const int count = GetParam().name == "thermal_all" ? 2 : 1;
  study::RenderScenes(GetParam(), count, 5, [](int index, const study::ImageScene& scene) {
    const CheckerboardResult result = FindCheckerboard(ToGrey(scene.image), scene.target);
    ASSERT_TRUE(result.board.has_value()) << index << ": " << result.why;
    const Errors errors = Compare(result.board->corners, scene.corners);
    // Half of the distance between the closest corners would be some 4 px; the noise allows 0.12 px
    // RMS at the lowest contrast and 6 m.
    EXPECT_LT(errors.worst, 1.0) << index;
    EXPECT_LT(errors.rms, 0.3) << index;
    // The board is rolled by less than 45 degrees: its top left is the image's.
    EXPECT_FALSE(errors.turned) << index;
    EXPECT_EQ(result.board->top_left_dark,
              GetParam().kind == CameraKind::kColor || scene.contrast_k < 0)
        << index;
  });
}

std::vector<study::SceneClass> TestedClasses() {
  std::vector<study::SceneClass> classes;
  for (const study::SceneClass& c : study::SceneClasses()) {
    // Colour takes a second to render; outdoors is tested in detect_test.cc.
    if (c.kind == CameraKind::kThermal || c.name == "color_night") classes.push_back(c);
  }
  return classes;
}

INSTANTIATE_TEST_SUITE_P(Checkerboard, RenderedBoard, ::testing::ValuesIn(TestedClasses()),
                         [](const auto& tested) { return tested.param.name; });

// Printed ones are even to a thousandth; wire meshes and tiles are not.
TEST(Checkerboard, AnUnevenGridIsNoBoard) {
  for (const double unevenness : {0.001, 0.003}) {
    PaintedCheckerboard painted;
    painted.noise = 1;
    painted.unevenness = unevenness;
    EXPECT_TRUE(FindCheckerboard(painted.Paint(), painted.target()).board) << unevenness;
  }
  for (const double unevenness : {0.02, 0.03}) {
    PaintedCheckerboard painted;
    painted.noise = 1;
    painted.unevenness = unevenness;
    EXPECT_FALSE(FindCheckerboard(painted.Paint(), painted.target()).board) << unevenness;
  }
}

// Gravel and leaves all over the image look like noise, and are not on the board.
TEST(Checkerboard, ABoardAmongTextureIsFound) {
  PaintedCheckerboard painted;
  painted.noise = 1;
  painted.square_px = 10;
  cv::Mat texture(480, 640, CV_32F);
  cv::RNG random(3);
  random.fill(texture, cv::RNG::NORMAL, 0, 40);
  painted.behind = [&](double x, double y) {
    const bool beside = std::hypot(x - painted.centre.x(), y - painted.centre.y()) > 90;
    return beside ? texture.at<float>(static_cast<int>(y), static_cast<int>(x)) : 0.0F;
  };
  const CheckerboardResult result = FindCheckerboard(painted.Paint(), painted.target());
  ASSERT_TRUE(result.board) << result.why;
  EXPECT_LT(Compare(result.board->corners, painted.Corners()).worst, 0.15);
}

TEST(Checkerboard, OrderIsTheTargetsInEveryTurnAndNeverMirrored) {
  for (const bool mirrored : {false, true}) {
    for (int step = 0; step < 8; ++step) {
      PaintedCheckerboard painted;
      painted.angle = 0.2 + step * 0.785;
      painted.mirrored = mirrored;
      painted.noise = 1;
      const CheckerboardResult result = FindCheckerboard(painted.Paint(), painted.target());
      ASSERT_TRUE(result.board.has_value()) << step << result.why;
      EXPECT_GT(Handedness(*result.board, painted.target()), 0) << step;
      if (mirrored) continue;
      const Errors errors = Compare(result.board->corners, painted.Corners());
      EXPECT_LT(errors.worst, 0.15) << step;
      // 11 + 8 is odd: the square in the opposite corner is white.
      EXPECT_EQ(result.board->top_left_dark, !errors.turned) << step;
    }
  }
}

TEST(Checkerboard, InvertedContrastTurnsThePolarityOnly) {
  PaintedCheckerboard painted;
  painted.noise = 1;
  const CheckerboardResult plain = FindCheckerboard(painted.Paint(), painted.target());
  const CheckerboardResult inverted = FindCheckerboard(300 - painted.Paint(), painted.target());
  ASSERT_TRUE(plain.board && inverted.board);
  EXPECT_NE(plain.board->top_left_dark, inverted.board->top_left_dark);
  EXPECT_LT(Compare(plain.board->corners, inverted.board->corners).worst, 1e-3);
}

TEST(Checkerboard, SigmaIsTheErrorThatNoiseMakes) {
  PaintedCheckerboard painted;
  painted.noise = 10;
  const CheckerboardResult result = FindCheckerboard(painted.Paint(), painted.target());
  ASSERT_TRUE(result.board.has_value()) << result.why;
  const double per_axis = Compare(result.board->corners, painted.Corners()).rms / std::sqrt(2.0);
  // 140 samples: 6% of the sigma. It is the worst direction's, which in these nearly square
  // corners is at most a fifth more than the mean one's.
  EXPECT_GT(result.board->sigma_px, 0.85 * per_axis);
  EXPECT_LT(result.board->sigma_px, 1.45 * per_axis);
}

TEST(Checkerboard, APatternOfAnotherSizeIsRefused) {
  PaintedCheckerboard painted;
  painted.noise = 1;
  const cv::Mat image = painted.Paint();
  for (const auto& [x, y] : {std::pair{-1, 0}, {0, -1}, {-4, -3}}) {
    Target target = painted.target();
    target.squares_x += x;
    target.squares_y += y;
    const CheckerboardResult result = FindCheckerboard(image, target);
    EXPECT_FALSE(result.board.has_value()) << x << " " << y;
    EXPECT_THAT(result.why, StartsWith("a checkerboard with more than")) << x << " " << y;
  }
  for (const auto& [x, y] : {std::pair{1, 0}, {0, 1}}) {
    Target target = painted.target();
    target.squares_x += x;
    target.squares_y += y;
    const CheckerboardResult result = FindCheckerboard(image, target);
    EXPECT_FALSE(result.board.has_value()) << x << " " << y;
    EXPECT_THAT(result.why, StartsWith("no checkerboard with")) << x << " " << y;
  }
}

// As the slats of a roller door may.
TEST(Checkerboard, WhatAlternatesBeyondItsBorderIsNoPartOfIt) {
  PaintedCheckerboard painted;
  painted.noise = 1;
  PaintedCheckerboard behind = painted;
  behind.squares_x += 2;
  behind.squares_y += 2;
  behind.contrast = 0.6 * painted.contrast;
  cv::Mat image = behind.Paint();
  const auto quadrangle = [&](double border) {
    std::vector<cv::Point> points;
    const double right = painted.squares_x + border;
    const double bottom = painted.squares_y + border;
    for (const auto& [x, y] :
         {std::pair{-border, -border}, {right, -border}, {right, bottom}, {-border, bottom}}) {
      const Eigen::Vector2d p = painted.Pixel(x, y);
      points.emplace_back(cvRound(p.x()), cvRound(p.y()));
    }
    return points;
  };
  cv::fillConvexPoly(image, quadrangle(0.25), cv::Scalar(100 + painted.contrast));
  cv::Mat pattern = cv::Mat::zeros(image.size(), CV_8U);
  cv::fillConvexPoly(pattern, quadrangle(0), cv::Scalar(255));
  painted.Paint().copyTo(image, pattern);
  const CheckerboardResult result = FindCheckerboard(image, painted.target());
  ASSERT_TRUE(result.board.has_value()) << result.why;
  EXPECT_LT(Compare(result.board->corners, painted.Corners()).worst, 0.3);
}

// White at 1.25 to 4 times what the image can show, with a good lens and a poor one; OpenCV's
// detector finds all of these, too, to 0.08 to 0.4 px.
TEST(Checkerboard, AnOverexposedBoardIsFoundAndItsCornersAreNotRoundedOff) {
  for (const auto& [exposure, halo] :
       {std::pair{1.6, 0.0}, {2.0, 0.3}, {3.0, 0.0}, {3.0, 0.3}, {5.0, 0.0}}) {
    double sum = 0;
    for (int seed = 0; seed < 6; ++seed) {
      OverexposedBoard board = OverexposedBoard::Draw(seed);
      board.exposure = exposure;
      board.halo = halo;
      const CheckerboardResult result =
          FindCheckerboard(board.Paint(), board.pattern.target(), 250);
      ASSERT_TRUE(result.board.has_value()) << exposure << " " << halo << ": " << result.why;
      const Errors errors = Compare(result.board->corners, board.pattern.Corners());
      EXPECT_LT(errors.worst, 0.15) << exposure << " " << halo << " " << seed;
      sum += errors.rms * errors.rms / 6;
    }
    EXPECT_LT(std::sqrt(sum), 0.035) << exposure << " " << halo;  // 0.017 is how it is painted
  }
}

TEST(Checkerboard, AnOverexposedPatternOfAnotherSizeIsRefused) {
  for (const double exposure : {2.0, 5.0}) {
    for (int seed = 0; seed < 2; ++seed) {
      OverexposedBoard board = OverexposedBoard::Draw(seed);
      board.exposure = exposure;
      const cv::Mat image = board.Paint();
      for (const auto& [x, y] : {std::pair{-1, 0}, {0, -1}, {1, 0}, {0, 1}, {-2, -1}}) {
        Target target = board.pattern.target();
        target.squares_x += x;
        target.squares_y += y;
        EXPECT_FALSE(FindCheckerboard(image, target, 250).board.has_value())
            << exposure << " " << seed << ": " << x << " " << y;
      }
    }
  }
}

TEST(Checkerboard, ScenesWithoutABoardHaveNone) {
  for (const auto& [name, scene] : simulate::kSceneNames) {
    simulate::Options options;
    options.scene = scene;
    options.supersampling = 2;
    options.cameras.erase(options.cameras.begin() + (scene == simulate::Scene::kOutdoor ? 1 : 0));
    const simulate::Simulator simulator(options);
    const Image image = simulator.TakeImage(options.cameras[0].name, 1'000'000);
    const CheckerboardResult result = FindCheckerboard(ToGrey(image), simulator.rig().target);
    EXPECT_FALSE(result.board.has_value()) << name;
    EXPECT_THAT(result.why, StartsWith("no checkerboard with 10x7 inner corners")) << name;
  }
}

// A perforated wall resembles a checkerboard, here even one of the right size.
TEST(Checkerboard, RowsOfHolesAreNoBoard) {
  cv::Mat image(480, 640, CV_32F);
  cv::RNG(3).fill(image, cv::RNG::NORMAL, 100, 1);
  const PaintedCheckerboard painted;
  for (int row = 0; row < painted.squares_y; ++row) {
    for (int column = (row + 1) % 2; column < painted.squares_x; column += 2) {
      cv::circle(image, {20 + 11 * column, 20 + 11 * row}, 5, cv::Scalar(160), cv::FILLED);
    }
  }
  EXPECT_FALSE(FindCheckerboard(image, painted.target()).board.has_value());
}

TEST(Checkerboard, OfTwoBoardsTheOneThatIsSeenBetterIsTaken) {
  PaintedCheckerboard near;
  near.noise = 1;
  near.square_px = 24;
  near.centre = {430, 260};
  PaintedCheckerboard far = near;
  far.square_px = 9;
  far.centre = {100, 90};
  for (const bool exchanged : {false, true}) {  // whichever is nearer to the image's beginning
    if (exchanged) near.centre = {200, 200};
    if (exchanged) far.centre = {540, 400};
    const cv::Mat both = cv::max(near.Paint(), far.Paint());
    ASSERT_TRUE(FindCheckerboard(far.Paint(), far.target()).board.has_value());
    const CheckerboardResult result = FindCheckerboard(both, near.target());
    ASSERT_TRUE(result.board.has_value()) << result.why;
    EXPECT_LT(Compare(result.board->corners, near.Corners()).worst, 0.15);
  }
}

TEST(Checkerboard, EachAbsenceHasItsReason) {
  const Target target = PaintedCheckerboard().target();
  EXPECT_EQ(FindCheckerboard(cv::Mat(), target).why, "the image is empty");
  EXPECT_EQ(FindCheckerboard(cv::Mat::zeros(480, 640, CV_32F), target).why,
            "the image is constant");
  EXPECT_EQ(FindCheckerboard(cv::Mat(1, 1, CV_32F, cv::Scalar(3)), target).why,
            "the image is constant");

  cv::Mat burnt = PaintedCheckerboard().Paint();
  burnt.rowRange(0, 300).setTo(255);
  EXPECT_EQ(FindCheckerboard(burnt, target).why,
            "the image is saturated: 63% of its pixels are at the upper end");
  EXPECT_EQ(FindCheckerboard(300 - burnt, target).why,
            "the image is saturated: 63% of its pixels are at the lower end");

  cv::Mat noise(480, 640, CV_32F);
  cv::RNG(1).fill(noise, cv::RNG::NORMAL, 100, 20);
  EXPECT_THAT(FindCheckerboard(noise, target).why,
              StartsWith("no checkerboard with 10x7 inner corners in the image"));

  Target tiny = target;
  tiny.squares_x = 3;
  EXPECT_THAT(FindCheckerboard(noise, tiny).why, HasSubstr("at least 3x3 are needed"));
}

TEST(Checkerboard, TheSameImageGivesTheSameBits) {
  PaintedCheckerboard painted;
  painted.noise = 10;
  const cv::Mat image = painted.Paint();
  const CheckerboardResult first = FindCheckerboard(image, painted.target());
  const CheckerboardResult second = FindCheckerboard(image.clone(), painted.target());
  ASSERT_TRUE(first.board && second.board);
  EXPECT_EQ(first.board->corners, second.board->corners);
}

}  // namespace
}  // namespace rgbdt
