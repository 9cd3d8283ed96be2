#pragma once

#include <cmath>
#include <functional>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "calib/model/rig.h"

namespace rgbdt {

/// A checkerboard drawn without a camera: seen at an angle, blurred, with noise and a background of
/// one's choice. Black is 100 and white 100 + contrast.
struct PaintedCheckerboard {
  int squares_x = 11, squares_y = 8;
  double square_px = 18, angle = 0.3;            ///< [rad] in the image
  Eigen::Vector2d centre{320, 240};              ///< [px]
  Eigen::Vector2d perspective{2e-4, -3e-4};      ///< [1/px]
  double contrast = 50, noise = 0, blur = 1;     ///< [px] sigma of the blur
  bool mirrored = false;                         ///< as seen in a mirror
  double unevenness = 0;                         ///< of a square: 1 sigma of each corner's place
  std::function<double(double, double)> behind;  ///< added to the image

  Eigen::Vector2d Pixel(double column, double row) const {
    cv::RNG own(static_cast<std::uint64_t>(1 + 100 * column + row) * 0x9e3779b97f4a7c15u);
    column += own.gaussian(unevenness);
    row += own.gaussian(unevenness);
    const double x = (mirrored ? -1 : 1) * (column - 0.5 * squares_x) * square_px;
    const double y = (row - 0.5 * squares_y) * square_px;
    const double w = 1 + perspective.x() * x + perspective.y() * y;
    return centre + Eigen::Vector2d(std::cos(angle) * x - std::sin(angle) * y,
                                    std::sin(angle) * x + std::cos(angle) * y) /
                        w;
  }

  Target target() const {
    Target t;
    t.squares_x = squares_x;
    t.squares_y = squares_y;
    t.square_m = 0.1;
    return t;
  }

  /// Inner corners in the target's order [px].
  std::vector<Eigen::Vector2d> Corners() const {
    std::vector<Eigen::Vector2d> corners;
    for (int row = 1; row < squares_y; ++row) {
      for (int column = 1; column < squares_x; ++column) corners.push_back(Pixel(column, row));
    }
    return corners;
  }

  cv::Mat Paint(cv::Size size = {640, 480}) const {
    constexpr int kFine = 4;  // rays along each side of a pixel
    cv::Mat fine(size * kFine, CV_32F, cv::Scalar(100));
    const auto at = [&](double column, double row) {
      const Eigen::Vector2d p = (Pixel(column, row).array() + 0.5) * kFine - 0.5;
      return cv::Point(static_cast<int>(std::lround(p.x() * 256)),
                       static_cast<int>(std::lround(p.y() * 256)));
    };
    for (int row = 0; row < squares_y; ++row) {
      for (int column = 0; column < squares_x; ++column) {
        if ((column + row) % 2 == 0) continue;  // the top left square is black
        const std::vector<cv::Point> square{at(column, row), at(column + 1, row),
                                            at(column + 1, row + 1), at(column, row + 1)};
        cv::fillConvexPoly(fine, square, cv::Scalar(100 + contrast), cv::LINE_8, 8);
      }
    }
    cv::Mat image;
    cv::resize(fine, image, size, 0, 0, cv::INTER_AREA);
    cv::GaussianBlur(image, image, {0, 0}, blur);
    cv::Mat grain(size, CV_32F);
    cv::RNG random(7);
    random.fill(grain, cv::RNG::NORMAL, 0, std::max(noise, 1e-9));
    image += grain;
    if (behind) {
      image.forEach<float>([&](float& value, const int* place) {
        value += static_cast<float>(behind(place[1], place[0]));
      });
    }
    return image;
  }
};

}  // namespace rgbdt
