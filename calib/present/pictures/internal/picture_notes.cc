#include "calib/present/pictures/internal/picture_notes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>

#include "calib/present/pictures/internal/cloud_colours.h"

namespace rgbdt {
namespace {

struct Axis {
  const char* name;
  Eigen::Vector3d in_view;  // picture's axes, length 1
  cv::Scalar bgr;
};

std::array<Axis, 3> AxesInView(const Viewpoint& viewpoint) {
  const Eigen::Matrix3d& r = viewpoint.view_from_lidar;
  std::array<Axis, 3> axes = {{{"x", r.col(0), {90, 90, 230}},
                               {"y", r.col(1), {90, 190, 90}},
                               {"z", r.col(2), {230, 150, 90}}}};
  // The one that points at the beholder is drawn over the others.
  std::sort(axes.begin(), axes.end(),
            [](const Axis& a, const Axis& b) { return a.in_view.z() > b.in_view.z(); });
  return axes;
}

cv::Point Tip(const Axis& axis, cv::Point foot, double length) {
  return foot + cv::Point(static_cast<int>(std::lround(length * axis.in_view.x())),
                          static_cast<int>(std::lround(length * axis.in_view.y())));
}

void MarkLidar(const Viewpoint& viewpoint, bool white_background, cv::Mat* picture) {
  const Eigen::Vector3d p = viewpoint * Eigen::Vector3d(0, 0, 0);
  if (p.z() < 0.1) return;
  const double x = (viewpoint.focal * p.x() / p.z() + viewpoint.cx) / kSupersampling;
  const double y = (viewpoint.focal * p.y() / p.z() + viewpoint.cy) / kSupersampling;
  if (!(x >= 0 && x < picture->cols && y >= 0 && y < picture->rows)) return;
  const cv::Point at(static_cast<int>(x), static_cast<int>(y));
  cv::circle(*picture, at, 6, TextColour(white_background), 1, cv::LINE_AA);
  const bool room = x < picture->cols - 80;
  DrawText("LIDAR", at + cv::Point(room ? 11 : -68, 5), white_background, picture);
}

}  // namespace

void DrawCaption(const DrawOptions& options, CloudColour colour, const std::vector<bool>& coloured,
                 cv::Mat* picture) {
  const auto count = std::count(coloured.begin(), coloured.end(), true);
  const double percent =
      coloured.empty() ? 0
                       : 100.0 * static_cast<double>(count) / static_cast<double>(coloured.size());
  const char* what = colour == CloudColour::kRgb       ? "seen in colour"
                     : colour == CloudColour::kThermal ? "seen by a thermal camera"
                                                       : "with an intensity";
  std::string text = options.title + (options.title.empty() ? "" : ":  ");
  text += std::to_string(coloured.size()) + " points, " + std::to_string(std::lround(percent)) +
          "% " + what;
  DrawText(text, {20, 32}, options.white_background, picture);
}

void DrawAxes(const Viewpoint& viewpoint, bool white_background, cv::Mat* picture) {
  constexpr double kLength = 38;  // [px]
  const cv::Point foot(64, picture->rows - 64);
  for (const Axis& axis : AxesInView(viewpoint)) {
    cv::line(*picture, foot, Tip(axis, foot, kLength), axis.bgr, 2, cv::LINE_AA);
    cv::putText(*picture, axis.name, Tip(axis, foot, 1.35 * kLength) + cv::Point(-5, 4),
                cv::FONT_HERSHEY_SIMPLEX, 0.5, axis.bgr, 1, cv::LINE_AA);
  }
  MarkLidar(viewpoint, white_background, picture);
}

}  // namespace rgbdt
