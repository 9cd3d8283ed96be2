#include "calib/present/pictures/map_picture.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "calib/model/errors.h"

namespace rgbdt {
namespace {

struct View {
  Eigen::Vector2d low{0, 0};  // [m] of the lower left corner
  double pixel_m = 1;
  int width = 1, height = 1;

  // The nearest pixel: a pose may lie anywhere.
  cv::Point At(const Eigen::Vector3d& p) const {
    const auto along = [this](double metres, int pixels) {
      return static_cast<int>(std::clamp(std::floor(metres / pixel_m), 0.0, pixels - 1.0));
    };
    return {along(p.x() - low.x(), width), height - 1 - along(p.y() - low.y(), height)};
  }
};

View ViewOf(const MapCloud& map, int most_px) {
  Eigen::Vector2d low = map.points[0].head<2>().cast<double>(), high = low;
  for (const Eigen::Vector3f& p : map.points) {
    low = low.cwiseMin(p.head<2>().cast<double>());
    high = high.cwiseMax(p.head<2>().cast<double>());
  }
  View view;
  view.low = low;
  view.pixel_m = std::max(map.voxel_m, (high - low).maxCoeff() / (most_px - 1));
  if (!(view.pixel_m > 0)) view.pixel_m = 1;
  view.width = static_cast<int>((high.x() - low.x()) / view.pixel_m) + 1;
  view.height = static_cast<int>((high.y() - low.y()) / view.pixel_m) + 1;
  return view;
}

// Where 2% and 98% of the heights lie [m].
std::pair<float, float> HeightRange(const MapCloud& map) {
  std::vector<float> heights;
  heights.reserve(map.size());
  for (const Eigen::Vector3f& p : map.points) heights.push_back(p.z());
  const auto at = [&heights](double share) {
    const auto place = heights.begin() +
                       static_cast<std::ptrdiff_t>(share * static_cast<double>(heights.size() - 1));
    std::nth_element(heights.begin(), place, heights.end());
    return *place;
  };
  const float low = at(0.02);
  return {low, at(0.98)};
}

cv::Vec3b ByHeight(float share) {
  const float s = std::clamp(share, 0.0F, 1.0F);
  return {cv::saturate_cast<uchar>(200 - 170 * s), cv::saturate_cast<uchar>(60 + 180 * s),
          cv::saturate_cast<uchar>(40 + 200 * s)};
}

}  // namespace

cv::Mat MapPicture(const MapCloud& map, const std::vector<Eigen::Vector3d>& way,
                   const std::vector<Eigen::Vector3d>& loops, int most_px) {
  if (map.points.empty()) throw InputError("the map has no points to draw");
  const View view = ViewOf(map, most_px);
  const auto [low, high] = HeightRange(map);
  cv::Mat picture(view.height, view.width, CV_8UC3, cv::Scalar(25, 25, 25));
  cv::Mat top(view.height, view.width, CV_32F, cv::Scalar(-1e30));
  for (std::size_t i = 0; i < map.size(); ++i) {
    const Eigen::Vector3f& p = map.points[i];
    const cv::Point pixel = view.At(p.cast<double>());
    if (p.z() <= top.at<float>(pixel)) continue;
    top.at<float>(pixel) = p.z();
    const auto& rgb = map.rgb[i];
    const bool coloured = rgb[0] != 0 || rgb[1] != 0 || rgb[2] != 0;
    picture.at<cv::Vec3b>(pixel) = coloured ? cv::Vec3b(rgb[2], rgb[1], rgb[0])
                                            : ByHeight((p.z() - low) / std::max(0.1F, high - low));
  }
  for (std::size_t i = 1; i < way.size(); ++i) {
    cv::line(picture, view.At(way[i - 1]), view.At(way[i]), cv::Scalar(40, 40, 255), 2);
  }
  for (const Eigen::Vector3d& place : loops) {
    cv::circle(picture, view.At(place), 6, cv::Scalar(60, 230, 60), 2);
  }
  return picture;
}

}  // namespace rgbdt
