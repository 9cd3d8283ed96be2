#include "calib/detect/image/internal/outline_by_opencv.h"

#include <algorithm>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <utility>

#include "calib/camera/pixels.h"

namespace rgbdt {
namespace {

// From the darkest to the brightest, but for a thousandth of the pixels at either end.
cv::Mat EightBits(const cv::Mat& grey) {
  const double low = Percentile(grey, 0.001), high = Percentile(grey, 0.999);
  const double scale = high > low ? 255 / (high - low) : 0;
  cv::Mat eight;
  grey.convertTo(eight, CV_8U, scale, -low * scale);
  return eight;
}

// The older findChessboardCorners takes minutes where noise is all over an image.
std::optional<std::vector<cv::Point2f>> InnerCorners(const cv::Mat& eight, const cv::Size& inner) {
  std::vector<cv::Point2f> corners;
  if (!cv::findChessboardCornersSB(eight, inner, corners, 0)) return std::nullopt;
  return corners;
}

// Where a pinhole of focal length 1 would see them.
std::optional<std::vector<cv::Point2f>> Straight(const Camera& camera,
                                                 const std::vector<cv::Point2f>& pixels) {
  std::vector<cv::Point2f> straight;
  for (const cv::Point2f& pixel : pixels) {
    const auto direction = camera.Unproject({pixel.x, pixel.y});
    if (!direction || direction->z() < 1e-3) return std::nullopt;
    straight.emplace_back(static_cast<float>(direction->x() / direction->z()),
                          static_cast<float>(direction->y() / direction->z()));
  }
  return straight;
}

std::vector<cv::Point2f> InPlane(const std::vector<Eigen::Vector3d>& points) {
  std::vector<cv::Point2f> out;
  out.reserve(points.size());
  for (const Eigen::Vector3d& p : points) {
    out.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()));
  }
  return out;
}

// The target's inner corners, the target turned by so many quarters.
std::vector<Eigen::Vector3d> TurnedCorners(const Target& target, int quarters) {
  std::vector<Eigen::Vector3d> corners = target.InnerCorners();
  const int wide = target.corners_x(), high = target.corners_y();
  if (quarters % 2 == 1) {  // of a square pattern: columns become rows
    std::vector<Eigen::Vector3d> turned;
    for (int row = 0; row < high; ++row) {
      for (int column = 0; column < wide; ++column) {
        turned.push_back(corners[static_cast<std::size_t>((high - 1 - column) * wide + row)]);
      }
    }
    corners = std::move(turned);
  }
  if (quarters >= 2) std::reverse(corners.begin(), corners.end());
  return corners;
}

// Nothing where it leaves the image.
std::optional<std::array<Eigen::Vector2d, 4>> OutlineOf(const Camera& camera, const Target& target,
                                                        const std::vector<cv::Point2f>& seen,
                                                        int quarters) {
  const cv::Mat to_image = cv::findHomography(InPlane(TurnedCorners(target, quarters)), seen);
  if (to_image.empty()) return std::nullopt;
  const auto outline = target.OutlineCorners();
  std::vector<cv::Point2f> where;
  cv::perspectiveTransform(InPlane({outline.begin(), outline.end()}), where, to_image);
  std::array<Eigen::Vector2d, 4> corners;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto pixel = camera.Project({where[i].x, where[i].y, 1.0});
    if (!pixel || !camera.Contains(*pixel)) return std::nullopt;
    corners[i] = *pixel;
  }
  return corners;
}

}  // namespace

std::vector<std::array<Eigen::Vector2d, 4>> OutlinesByOpenCv(const cv::Mat& grey,
                                                             const Camera& camera,
                                                             const Target& target) {
  constexpr int kLeastCorners = 3;  // OpenCV's
  if (std::min(target.corners_x(), target.corners_y()) < kLeastCorners) return {};
  const auto corners = InnerCorners(EightBits(grey), {target.corners_x(), target.corners_y()});
  if (!corners) return {};
  const auto seen = Straight(camera, *corners);
  if (!seen) return {};
  const bool off_centre = !target.pattern_offset_m.isZero(0);
  const bool square = target.squares_x == target.squares_y;
  std::vector<std::array<Eigen::Vector2d, 4>> outlines;
  for (int quarters = 0; quarters < 4; ++quarters) {
    if ((quarters % 2 == 1 && !square) || (quarters >= 2 && !off_centre)) continue;
    if (const auto outline = OutlineOf(camera, target, *seen, quarters))
      outlines.push_back(*outline);
  }
  return outlines;
}

}  // namespace rgbdt
