#include "calib/detect/image/internal/corner_fit.h"

#include <gtest/gtest.h>

#include "calib/detect/image/internal/grey_image.h"
#include "tests/unit/detect/image/painted_checkerboard.h"

namespace rgbdt {
namespace {

Eigen::Matrix2d StepsAt(const PaintedCheckerboard& board, int column, int row) {
  Eigen::Matrix2d steps;
  steps << board.Pixel(column + 0.5, row) - board.Pixel(column - 0.5, row),
      board.Pixel(column, row + 0.5) - board.Pixel(column, row - 0.5);
  return steps;
}

const Eigen::Matrix2d kStraight = Eigen::Matrix2d::Zero();

double WorstError(const PaintedCheckerboard& board, std::optional<double> blur) {
  const cv::Mat image = board.Paint();
  double worst = 0;
  for (int row = 1; row < board.squares_y; ++row) {
    for (int column = 1; column < board.squares_x; ++column) {
      const Eigen::Vector2d truth = board.Pixel(column, row);
      const auto fit = FitCorner(image, truth + Eigen::Vector2d(0.6, -0.5),
                                 StepsAt(board, column, row), kStraight, blur);
      if (!fit) return 1e9;
      worst = std::max(worst, (fit->place - truth).norm());
    }
  }
  return worst;
}

// What remains is how finely the test paints edges: four rays a pixel.
TEST(CornerFit, FindsCornersToAFewHundredths) {
  EXPECT_LT(WorstError(PaintedCheckerboard(), {}), 0.05);
}

TEST(CornerFit, AGlowTenTimesTheContrastDoesNotMoveThem) {
  PaintedCheckerboard board;
  board.behind = [&](double x, double y) {
    return 10 * board.contrast *
           std::exp(-(std::hypot(x - 350, y - 220) / 80) / 2 * (std::hypot(x - 350, y - 220) / 80));
  };
  EXPECT_LT(WorstError(board, {}), 0.05);
  EXPECT_LT(WorstError(board, 1.1), 0.05);
}

// Edges that a lens bends, 1 px over 80 px: nothing is drawn towards their hollow side.
TEST(CornerFit, BentEdgesDoNotMoveTheCorner) {
  constexpr double kCurvature = 3e-4;  // [1/px]
  constexpr double kStep = 30;
  const Eigen::Vector2d truth(50.3, 40.7);
  cv::Mat image(90, 100, CV_32FC1);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const double dx = x - truth.x();
      const double dy = y - truth.y();
      const auto step = [](double e) { return std::erf(e / (std::sqrt(2.0) * 1.1)); };
      image.at<float>(y, x) = static_cast<float>(100 + 40 * step(dx - 0.5 * kCurvature * dy * dy) *
                                                           step(dy - 0.5 * kCurvature * dx * dx));
    }
  }
  const Eigen::Matrix2d steps = kStep * Eigen::Matrix2d::Identity();
  Eigen::Matrix2d bends;  // along x the place moves in y, and the other way round
  bends << 0, kCurvature * kStep * kStep, kCurvature * kStep * kStep, 0;
  const auto error = [&](const Eigen::Matrix2d& told) {
    const auto fit = FitCorner(image, truth + Eigen::Vector2d(0.4, -0.3), steps, told, 1.1);
    return fit ? (fit->place - truth).norm() : 1e9;
  };
  EXPECT_LT(error(bends), 2e-4);
  EXPECT_GT(error(kStraight), 2e-3);  // what it is for
}

// Warmth that changes within a square, as where an edge is as warm as its background.
TEST(CornerFit, ABendInTheBackgroundIsFollowedWhereTheBlurIsKnown) {
  PaintedCheckerboard board;
  board.behind = [&](double x, double) {
    const double beyond = std::max(0.0, x - 320) / board.square_px;
    return x < 420 ? 2 * board.contrast * beyond * beyond : 0;
  };
  const Eigen::Vector2d truth = board.Pixel(6, 4);
  ASSERT_NEAR(truth.x(), 320, 10);
  const auto fit = FitCorner(board.Paint(), truth, StepsAt(board, 6, 4), kStraight, 1.04);
  ASSERT_TRUE(fit.has_value());
  EXPECT_LT((fit->place - truth).norm(), 0.1);
}

TEST(CornerFit, ContrastTellsWhichPatchesAreLight) {
  PaintedCheckerboard board;
  for (const bool inverted : {false, true}) {
    board.contrast = inverted ? -50 : 50;
    const auto fit = FitCorner(board.Paint(), board.Pixel(5, 4), StepsAt(board, 5, 4), kStraight);
    ASSERT_TRUE(fit.has_value());
    // Square (5, 4) has an odd sum: white.
    EXPECT_NEAR(fit->contrast, inverted ? -25 : 25, 1);
    // The blur, and a pixel's own area.
    EXPECT_NEAR(fit->blur_px, std::sqrt(1 + 1 / 12.0), 0.05);
  }
}

// One of a marker's corners, dark or light, with its code inside of a border of 6 px.
TEST(CornerFit, TheCornerOfASquareThatStandsAlone) {
  const Eigen::Matrix2d steps = 16 * Eigen::Matrix2d::Identity();
  const Eigen::Vector2d truth(50.3, 40.7);
  for (const LonePatch& lone : {LonePatch(1, 1), LonePatch(-1, 1), LonePatch(1, -1)}) {
    for (const double inside : {-80.0, 80.0}) {
      cv::Mat image(90, 100, CV_32FC1);
      for (int y = 0; y < image.rows; ++y) {
        for (int x = 0; x < image.cols; ++x) {
          const auto part = [](double e) {
            return 0.5 * (1 + std::erf(e / (std::sqrt(2.0) * 1.1)));
          };
          const double dx = lone.x() * (x - truth.x());
          const double dy = lone.y() * (y - truth.y());
          const double code = part(dx - 6) * part(dy - 6) * (x % 8 < 4 ? -0.9 : 0);
          image.at<float>(y, x) =
              static_cast<float>(100 + 0.05 * x + inside * (part(dx) * part(dy) + code));
        }
      }
      const auto fit = FitCorner(image, truth + Eigen::Vector2d(0.4, -0.3), steps, kStraight, {},
                                 kNeverSaturated, 4.0 / 16, lone);
      ASSERT_TRUE(fit.has_value()) << lone.transpose() << " " << inside;
      EXPECT_LT((fit->place - truth).norm(), 0.02) << lone.transpose() << " " << inside;
      EXPECT_NEAR(fit->contrast, 0.5 * inside, 3);
      EXPECT_NEAR(fit->blur_px, 1.1, 0.1);
      // Where light is clipped, the dark side of the corner still tells its place.
      const double level = inside < 0 ? 95 : 150;
      cv::Mat clipped = cv::min(image, level);
      const auto bounded = FitCorner(clipped, truth, steps, kStraight, 1.1, level, 4.0 / 16, lone);
      ASSERT_TRUE(bounded.has_value());
      EXPECT_TRUE(bounded->saturated);
      EXPECT_LT((bounded->place - truth).norm(), 0.1) << lone.transpose() << " " << inside;
    }
  }
}

TEST(CornerFit, NothingWhereThereIsNoCorner) {
  const PaintedCheckerboard board;
  const cv::Mat image = board.Paint();
  const Eigen::Matrix2d steps = StepsAt(board, 5, 4);
  EXPECT_FALSE(FitCorner(image, {2, 240}, steps, kStraight).has_value());  // at the image's border
  EXPECT_FALSE(
      FitCorner(image, {320, 240}, 0.1 * steps, kStraight).has_value());  // squares of 2 px
  const auto edge = FitCorner(image, board.Pixel(5.5, 4), steps, kStraight);
  EXPECT_TRUE(!edge || edge->sigma_px > 0.2 || std::abs(edge->contrast) < 5);
}

TEST(GreyImage, DeadPixelsAreRepairedAndSquaresAreNot) {
  PaintedCheckerboard board;
  board.square_px = 9;
  board.noise = 1;
  const cv::Mat clean = board.Paint();
  cv::Mat image = clean.clone();
  const std::vector<cv::Point> dead{{100, 100}, {310, 230}, {331, 250}, {332, 250}};
  for (std::size_t i = 0; i < dead.size(); ++i) image.at<float>(dead[i]) = i % 2 == 0 ? 0 : 16383;
  const cv::Mat repaired = RepairDeadPixels(image);
  for (const cv::Point& p : dead) {
    // On the board neighbours differ by up to the contrast.
    EXPECT_NEAR(repaired.at<float>(p), clean.at<float>(p), p.x == 100 ? 5 : 50);
  }
  EXPECT_EQ(cv::countNonZero(RepairDeadPixels(clean) != clean), 0);
}

// As raw images of thermal cameras have them.
TEST(GreyImage, DeadColumnsAndRowsAreRepaired) {
  PaintedCheckerboard board;
  board.square_px = 9;
  board.noise = 1;
  const cv::Mat clean = board.Paint();
  cv::Mat image = clean.clone();
  image.col(310) = 0;
  image.col(334) = 16383;
  image.row(240) = 16383;
  const cv::Mat repaired = RepairDeadPixels(image);
  EXPECT_LT(cv::norm(repaired, clean, cv::NORM_INF), 50);  // as above
  EXPECT_LT(cv::countNonZero(repaired != clean), 2 * image.rows + image.cols + 20);
}

TEST(GreyImage, InterpolatesBetweenPixels) {
  cv::Mat image(3, 3, CV_32F);
  for (int i = 0; i < 9; ++i) image.at<float>(i / 3, i % 3) = static_cast<float>(i * i);
  EXPECT_FLOAT_EQ(Interpolate(image, 1, 1), 16);
  EXPECT_FLOAT_EQ(Interpolate(image, 2, 2), 64);
  EXPECT_FLOAT_EQ(Interpolate(image, 0.5, 0.5), (0 + 1 + 9 + 16) / 4.0F);
  EXPECT_TRUE(std::isnan(Interpolate(image, 2.01, 1)));
  EXPECT_TRUE(std::isnan(Interpolate(image, 1, -0.01)));
}

}  // namespace
}  // namespace rgbdt
