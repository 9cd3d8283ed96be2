#include "calib/methods/scene/seen_points.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "calib/camera/pixels.h"

namespace rgbdt {
namespace {

bool IsNear(const Camera& camera, const Eigen::Vector2d& pixel) {
  const double margin = 0.1 * camera.width();
  return pixel.x() > -margin && pixel.y() > -margin && pixel.x() < camera.width() + margin &&
         pixel.y() < camera.height() + margin;
}

}  // namespace

std::vector<std::size_t> PointsNearImage(const Camera& camera, const Rigid3& camera_from_lidar,
                                         const std::vector<Eigen::Vector3f>& points,
                                         std::size_t most) {
  std::vector<std::size_t> near;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!points[i].allFinite()) continue;
    const auto pixel = camera.Project(camera_from_lidar * points[i].cast<double>());
    if (pixel && IsNear(camera, *pixel)) near.push_back(i);
  }
  if (near.size() <= most) return near;
  std::vector<std::size_t> some(most);
  for (std::size_t i = 0; i < most; ++i) some[i] = near[i * near.size() / most];
  return some;
}

std::vector<cv::Mat> GreyValues(const CameraSpec& camera, const std::vector<Shot>& shots) {
  std::vector<cv::Mat> values;
  float black = 0;
  float white = 0;
  for (const Shot& shot : shots) {
    CheckImage(camera, *shot.image);
    values.push_back(ToGrey(*shot.image));
    const auto [low, high] = StretchLimits(values.back());
    black = values.size() == 1 ? low : std::min(black, low);
    white = values.size() == 1 ? high : std::max(white, high);
  }
  for (cv::Mat& value : values) {
    value.convertTo(value, CV_32F, 1 / (white - black), -black / (white - black));
    cv::threshold(value, value, 0, 0, cv::THRESH_TOZERO);
    cv::threshold(value, value, 1, 1, cv::THRESH_TRUNC);
  }
  return values;
}

std::string WhyTooFew(std::size_t seen, std::size_t least, const std::string& what) {
  if (seen >= least) return "";
  return std::to_string(seen) + " " + what + " lie in the images, expected " +
         std::to_string(least) +
         " or more: look whether the guess points the camera at what the LIDAR sees";
}

}  // namespace rgbdt
