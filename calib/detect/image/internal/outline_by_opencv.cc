#include "calib/detect/image/internal/outline_by_opencv.h"

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

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

std::optional<std::vector<cv::Point2f>> InnerCorners(const cv::Mat& eight, const cv::Size& inner) {
  constexpr int kFlags = cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE;
  std::vector<cv::Point2f> corners;
  if (cv::findChessboardCorners(eight, inner, corners, kFlags)) return corners;
  if (cv::findChessboardCornersSB(eight, inner, corners, cv::CALIB_CB_NORMALIZE_IMAGE)) {
    return corners;
  }
  return std::nullopt;
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
  for (const Eigen::Vector3d& p : points) {
    out.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()));
  }
  return out;
}

}  // namespace

std::optional<std::array<Eigen::Vector2d, 4>> OutlineByOpenCv(const cv::Mat& grey,
                                                              const Camera& camera,
                                                              const Target& target) {
  const auto corners = InnerCorners(EightBits(grey), {target.corners_x(), target.corners_y()});
  if (!corners) return std::nullopt;
  const auto seen = Straight(camera, *corners);
  if (!seen) return std::nullopt;
  const cv::Mat to_image = cv::findHomography(InPlane(target.InnerCorners()), *seen);
  if (to_image.empty()) return std::nullopt;
  const auto outline = target.OutlineCorners();
  std::vector<cv::Point2f> where;
  cv::perspectiveTransform(InPlane({outline.begin(), outline.end()}), where, to_image);
  std::array<Eigen::Vector2d, 4> picks;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto pixel = camera.Project({where[i].x, where[i].y, 1.0});
    if (!pixel || !camera.Contains(*pixel)) return std::nullopt;
    picks[i] = *pixel;
  }
  return picks;
}

}  // namespace rgbdt
