#pragma once

#include <cmath>
#include <functional>
#include <opencv2/core.hpp>
#include <optional>
#include <random>
#include <vector>

#include "calib/camera/camera.h"
#include "calib/camera/target_pose.h"
#include "calib/model/image.h"
#include "calib/model/rig.h"

namespace rgbdt {

/// A board that faces the camera squarely, painted by formula: a rectangle blurred by a Gaussian is
/// a product of error functions, so its sides are known to any digit. No lens distortion.
struct PaintedBoard {
  Target target;                     ///< as the rig file has it
  double wider_m = 0, higher_m = 0;  ///< the painted board's size beyond the target's
  double distance_m = 3, turn_rad = 0.2;
  Eigen::Vector2d centre_px{319.3, 240.4};
  double black = 60, white = 180;
  bool light_pattern = true;  ///< whether squares are painted at all
  /// Grey value behind the board at a pixel.
  std::function<double(double, double)> background = [](double, double) { return 110.0; };
  double blur_px = 1.0, noise = 0;
  int width = 640, height = 480;

  PaintedBoard() {
    target.squares_x = 11;
    target.squares_y = 8;
    target.square_m = 0.1;
    target.width_m = 1.2192;
    target.height_m = 0.9144;
  }

  CameraSpec spec() const {
    CameraSpec spec;
    spec.name = "painted";
    spec.width = width;
    spec.height = height;
    spec.lens.fx = spec.lens.fy = 1000;
    spec.lens.cx = 0.5 * (width - 1);
    spec.lens.cy = 0.5 * (height - 1);
    spec.format = PixelFormat::kMono8;
    return spec;
  }

  Rigid3 camera_from_target() const {
    Rigid3 pose = RotationAbout({0, 0, 1}, turn_rad);
    const CameraSpec s = spec();
    pose.translation = {(centre_px.x() - s.lens.cx) * distance_m / s.lens.fx,
                        (centre_px.y() - s.lens.cy) * distance_m / s.lens.fy, distance_m};
    return pose;
  }

  /// The pose as corners of 0.05 px would give it, but without their error.
  TargetPose pose() const {
    std::vector<Eigen::Vector2d> corners = Corners();
    TargetPose pose = PoseFromCorners(Camera(spec()), target, corners)->pose;
    pose.covariance *= 25;  // the floor of sigma is 0.01 px
    return pose;
  }

  std::vector<Eigen::Vector2d> Corners() const {
    const Camera camera(spec());
    std::vector<Eigen::Vector2d> corners;
    for (const Eigen::Vector3d& p : target.InnerCorners()) {
      corners.push_back(*camera.Project(camera_from_target() * p));
    }
    return corners;
  }

  double px_per_m() const { return spec().lens.fx / distance_m; }

  Image Paint(std::uint32_t seed = 1) const {
    Image image;
    image.camera = "painted";
    image.format = PixelFormat::kMono8;
    image.pixels.create(height, width, CV_8U);
    std::mt19937 random(seed);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        double error = 0;  // of 12 even numbers, less 6: near enough to normal
        for (int i = 0; i < 12 && noise > 0; ++i) error += random() / 4294967296.0;
        const double value = ValueAt(x, y) + (noise > 0 ? noise * (error - 6) : 0);
        image.pixels.at<std::uint8_t>(y, x) = cv::saturate_cast<std::uint8_t>(std::lround(value));
      }
    }
    return image;
  }

 private:
  // How much of a rectangle lies under the blur at p; target frame, pixels.
  double Cover(const Eigen::Vector2d& p, const Eigen::Vector2d& low,
               const Eigen::Vector2d& high) const {
    const double scale = 1 / (std::sqrt(2.0) * blur_px);
    double cover = 1;
    for (int k = 0; k < 2; ++k) {
      cover *= 0.5 * (std::erf((p[k] - low[k]) * scale) - std::erf((p[k] - high[k]) * scale));
    }
    return cover;
  }

  double ValueAt(double x, double y) const {
    const Eigen::Vector2d off(x - centre_px.x(), y - centre_px.y());
    const Eigen::Vector2d p(std::cos(turn_rad) * off.x() + std::sin(turn_rad) * off.y(),
                            -std::sin(turn_rad) * off.x() + std::cos(turn_rad) * off.y());
    const double m = px_per_m();
    const Eigen::Vector2d half(0.5 * m * (target.width_m + wider_m),
                               0.5 * m * (target.height_m + higher_m));
    const double behind = background(x, y);
    const double board = Cover(p, -half, half);
    double value = behind + board * (black - behind);
    if (!light_pattern || board < 0.5) return value;
    const double square = m * target.square_m;
    const Eigen::Vector2d first(m * target.pattern_offset_m.x() - 0.5 * target.squares_x * square,
                                m * target.pattern_offset_m.y() - 0.5 * target.squares_y * square);
    for (int row = 0; row < target.squares_y; ++row) {
      for (int column = 1 - row % 2; column < target.squares_x; column += 2) {
        const Eigen::Vector2d low = first + square * Eigen::Vector2d(column, row);
        if (((p - low).array() < -5 * blur_px).any()) continue;
        if (((p - low).array() > square + 5 * blur_px).any()) continue;
        value += (white - black) * Cover(p, low, low + Eigen::Vector2d(square, square));
      }
    }
    return value;
  }
};

}  // namespace rgbdt
