#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "calib/camera/camera.h"
#include "calib/model/rig.h"
#include "calib/model/statistics.h"
#include "calib/model/view_detection.h"
#include "tests/unit/matchers.h"

namespace rgbdt {

/// What stands between camera and board.
enum class Cover {
  kPerson,  ///< head and trunk before the board's middle or to one side
  kBar,     ///< aslant across it, a third of its height wide
  kHalf,    ///< everything to the left of a wavy line: half of the board
  kBranch,  ///< a few thin ones
};

/// Whether a cover hides a place on the board; u, v: -0.5 to 0.5 along width and height.
/// `aside` moves it along the width.
inline bool Hides(Cover cover, double aside, double u, double v) {
  u -= aside;
  switch (cover) {
    case Cover::kPerson:
      return std::hypot(u / 0.09, (v + 0.3) / 0.13) < 1 || (v > -0.17 && std::abs(u) < 0.17);
    case Cover::kBar:
      return std::abs(v - 0.8 * u) < 0.17;
    case Cover::kHalf:
      return u < 0.03 * std::sin(14 * v);
    case Cover::kBranch:
      return std::abs(v - 0.5 * u) < 0.025 || std::abs(v + 0.9 * u - 0.15) < 0.02 ||
             std::abs(u + 0.3 * v + 0.1) < 0.02;
  }
  return false;
}

/// Mean and noise of the pixels that a cover is painted with: those of the image near the board.
struct Paint {
  double mean = 0, noise = 0;
};

inline Paint PaintLike(const cv::Mat& pixels, const cv::Rect& around) {
  cv::Mat values;
  pixels(around).convertTo(values, CV_32F);
  std::vector<float> steps;  // two pixels on: the same colour of a mosaic
  for (int y = 0; y < values.rows; ++y) {
    for (int x = 0; x + 2 < values.cols; ++x) {
      steps.push_back(std::abs(values.at<float>(y, x + 2) - values.at<float>(y, x)));
    }
  }
  return {cv::mean(values)[0], Median(std::move(steps)) / (0.6745 * std::sqrt(2.0))};
}

/// Paints a cover over the board in raw pixels (8 or 16 bit, a mosaic stays one): brightness as
/// near the board, uneven by a few noise levels and by a tenth, with noise.
inline void PaintCover(const Camera& camera, const Target& target, const Rigid3& camera_from_target,
                       Cover cover, double aside, Random* random, cv::Mat* pixels) {
  std::vector<cv::Point2f> seen;
  for (const Eigen::Vector3d& corner : target.OutlineCorners()) {
    const Eigen::Vector2d p = *camera.Project(camera_from_target * corner);
    seen.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()));
  }
  const std::vector<cv::Point2f> unit{{-0.5F, -0.5F}, {0.5F, -0.5F}, {0.5F, 0.5F}, {-0.5F, 0.5F}};
  const cv::Matx33d board_from_image = cv::Mat(cv::getPerspectiveTransform(seen, unit));
  cv::Rect box = cv::boundingRect(seen);
  box.x -= box.width / 4;
  box.y -= box.height / 4;
  box.width += box.width / 2;
  box.height += box.height / 2;
  box &= cv::Rect(0, 0, pixels->cols, pixels->rows);
  const Paint paint = PaintLike(*pixels, box);
  for (int y = box.y; y < box.y + box.height; ++y) {
    for (int x = box.x; x < box.x + box.width; ++x) {
      const cv::Vec3d p = board_from_image * cv::Vec3d(x, y, 1);
      const double u = p[0] / p[2];
      const double v = p[1] / p[2];
      if (!Hides(cover, aside, u, v)) continue;
      const double uneven = std::sin(9 * u + 5 * v) * (3 * paint.noise + 0.01 * paint.mean);
      const double value =
          std::max(0.0, paint.mean + uneven + paint.noise * 1.7 * random->Uniform(-1, 1));
      if (pixels->depth() == CV_8U) {
        pixels->at<std::uint8_t>(y, x) = cv::saturate_cast<std::uint8_t>(value);
      } else {
        pixels->at<std::uint16_t>(y, x) = cv::saturate_cast<std::uint16_t>(value);
      }
    }
  }
}

/// What a person clicks: the true outline corners, each up to `off_px` off along x and y, beginning
/// anywhere and either way round.
inline CornerSelection PicksNear(const Camera& camera, const Target& target,
                                 const Rigid3& camera_from_target, double off_px, Random* random) {
  CornerSelection picks;
  const auto corners = target.OutlineCorners();
  for (std::size_t i = 0; i < 4; ++i) {
    picks.corners[i] =
        *camera.Project(camera_from_target * corners[i]) +
        Eigen::Vector2d(random->Uniform(-off_px, off_px), random->Uniform(-off_px, off_px));
  }
  const auto first = static_cast<std::ptrdiff_t>(random->Uniform(0, 3.999));
  std::rotate(picks.corners.begin(), picks.corners.begin() + first, picks.corners.end());
  if (random->Uniform(0, 1) < 0.5) std::reverse(picks.corners.begin(), picks.corners.end());
  return picks;
}

}  // namespace rgbdt
