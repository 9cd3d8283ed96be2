#pragma once

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "tests/unit/detect/image/painted_checkerboard.h"

namespace rgbdt {

/// A white board as it stands in a workshop: its pattern in the middle of a wide margin, lines
/// drawn with a thick pen beside it, a grey wall behind, and seen too brightly.
struct OverexposedBoard {
  PaintedCheckerboard pattern;  ///< its place; its contrast, noise and background are not used
  double exposure = 3;          ///< white is 200 times that, before it is clipped at 255
  double halo = 0;              ///< share of the light that a poor lens spreads four times as wide
  double noise = 2;
  int seed = 1;

  /// Of one of many boards: size, place, slant and blur are drawn.
  static OverexposedBoard Draw(int seed) {
    cv::RNG random(static_cast<std::uint64_t>(17 * seed + 3));
    OverexposedBoard board;
    board.seed = seed;
    PaintedCheckerboard& p = board.pattern;
    p.squares_x = 8;
    p.squares_y = 6;
    p.square_px = random.uniform(16.0, 34.0);
    p.angle = random.uniform(-0.5, 0.5);
    p.perspective = {random.uniform(-5e-4, 5e-4), random.uniform(-5e-4, 5e-4)};
    p.blur = random.uniform(0.8, 1.8);
    p.centre = {random.uniform(300.0, 340.0), random.uniform(220.0, 260.0)};
    return board;
  }

  /// 8 bits, as CV_32FC1.
  cv::Mat Paint(cv::Size size = {640, 480}) const {
    cv::Mat fine(size * kFine, CV_32F, cv::Scalar(60));
    PaintBoard(&fine);
    PaintLines(&fine);
    cv::Mat image;
    cv::resize(fine, image, size, 0, 0, cv::INTER_AREA);
    cv::Mat sharp;
    cv::Mat wide;
    cv::GaussianBlur(image, sharp, {0, 0}, pattern.blur);
    cv::GaussianBlur(image, wide, {0, 0}, 4 * pattern.blur);
    cv::Mat grain(size, CV_32F);
    cv::RNG(static_cast<std::uint64_t>(seed + 99)).fill(grain, cv::RNG::NORMAL, 0, noise);
    image = exposure * ((1 - halo) * sharp + halo * wide) + grain;
    cv::Mat eight;
    image.convertTo(eight, CV_8U);  // clips and rounds
    eight.convertTo(image, CV_32F);
    return image;
  }

 private:
  static constexpr int kFine = 8;  // rays along each side of a pixel
  static constexpr double kMargin = 1.2;
  static constexpr double kBlack = 25, kWhite = 200;

  // (column, row) are in squares from the pattern's top left corner.
  void PaintQuadrangle(const std::vector<Eigen::Vector2d>& corners, double value,
                       cv::Mat* fine) const {
    std::vector<cv::Point> points;
    for (const Eigen::Vector2d& corner : corners) {
      const Eigen::Vector2d p =
          ((pattern.Pixel(corner.x(), corner.y()).array() + 0.5) * kFine - 0.5) * 256;
      points.emplace_back(cvRound(p.x()), cvRound(p.y()));
    }
    cv::fillConvexPoly(*fine, points, cv::Scalar(value), cv::LINE_8, 8);
  }

  void PaintBoard(cv::Mat* fine) const {
    const double right = pattern.squares_x + kMargin;
    const double bottom = pattern.squares_y + kMargin;
    PaintQuadrangle({{-kMargin, -kMargin}, {right, -kMargin}, {right, bottom}, {-kMargin, bottom}},
                    kWhite, fine);
    for (int row = 0; row < pattern.squares_y; ++row) {
      for (int column = row % 2; column < pattern.squares_x; column += 2) {
        PaintQuadrangle(
            {{column, row}, {column + 1, row}, {column + 1, row + 1}, {column, row + 1}}, kBlack,
            fine);
      }
    }
  }

  void PaintLine(const Eigen::Vector2d& from, const Eigen::Vector2d& to, cv::Mat* fine) const {
    const Eigen::Vector2d along = (to - from).normalized();
    const Eigen::Vector2d aside = 0.04 * Eigen::Vector2d(-along.y(), along.x());
    PaintQuadrangle({from + aside, to + aside, to - aside, from - aside}, kBlack, fine);
  }

  void PaintLines(cv::Mat* fine) const {
    cv::RNG random(static_cast<std::uint64_t>(seed));
    const double wide = pattern.squares_x;
    const double high = pattern.squares_y;
    const auto beside = [&] { return random.uniform(0.1, kMargin); };
    for (int i = 0; i < 2; ++i) {
      PaintLine({random.uniform(0.0, 3.0), -beside()}, {wide, -beside()}, fine);
      PaintLine({0, high + beside()}, {random.uniform(4.0, wide), high + beside()}, fine);
      PaintLine({-beside(), 0}, {-beside(), random.uniform(3.0, high)}, fine);
      PaintLine({wide + beside(), random.uniform(0.0, 3.0)}, {wide + beside(), high}, fine);
    }
  }
};

}  // namespace rgbdt
