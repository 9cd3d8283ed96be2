#include "calib/present/pictures/cloud_picture.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "calib/model/check.h"
#include "calib/model/errors.h"
#include "calib/present/pictures/internal/cloud_colours.h"
#include "calib/present/pictures/internal/picture_notes.h"
#include "calib/present/pictures/internal/point_radius.h"
#include "calib/present/pictures/internal/splats.h"
#include "calib/present/pictures/internal/viewpoint.h"

namespace rgbdt {
namespace {

std::vector<Splat> Project(const RgbdtCloud& cloud, const PointColours& colours,
                           const Viewpoint& viewpoint, const DrawOptions& options) {
  const std::vector<float> radii = PointRadii(cloud.points);
  // What stands between the eye and the LIDAR would hide what the LIDAR looks at.
  const double lidar = (viewpoint * Eigen::Vector3d(0, 0, 0)).z();
  const double nearest = options.eye ? 0.1 : std::max(0.1, lidar);
  std::vector<Splat> splats;
  splats.reserve(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!cloud.points[i].allFinite()) continue;
    const Eigen::Vector3d p = viewpoint * cloud.points[i].cast<double>();
    if (p.z() < (colours.coloured[i] ? 0.1 : nearest)) continue;
    const double scale = viewpoint.focal / p.z();
    const cv::Point2d centre(scale * p.x() + viewpoint.cx, scale * p.y() + viewpoint.cy);
    if (std::abs(centre.x) > 1e5 || std::abs(centre.y) > 1e5) continue;
    const double radius = std::clamp(options.point_size * radii[i] * scale, 0.6 * kSupersampling,
                                     15.0 * kSupersampling);
    splats.push_back({centre, radius, static_cast<float>(p.z()), colours.bgr[i]});
  }
  return splats;
}

// A LIDAR of few rings leaves most of the picture empty: its points are drawn larger, so that their
// colours can be seen at all.
void GrowSparse(const cv::Size& size, std::vector<Splat>* splats) {
  constexpr double kWanted = 0.35, kMost = 2.2;
  const cv::Rect2d whole(0, 0, size.width, size.height);
  double covered = 0;  // overlaps count twice: a dense cloud stays as it is
  for (const Splat& splat : *splats) {
    if (whole.contains(splat.centre)) covered += M_PI * splat.radius * splat.radius;
  }
  const double growth =
      std::clamp(std::sqrt(kWanted * whole.area() / std::max(covered, 1.0)), 1.0, kMost);
  for (Splat& splat : *splats) splat.radius *= growth;
}

// From dark above to a dark grey below: what is not there is not quite black.
cv::Mat Background(const cv::Size& size, bool white) {
  cv::Mat background(size, CV_8UC3);
  for (int y = 0; y < size.height; ++y) {
    const int grey = 16 + 32 * y / size.height;
    background.row(y).setTo(cv::Scalar::all(white ? 255 : grey));
  }
  return background;
}

void CheckCloud(const RgbdtCloud& cloud) {
  const std::size_t n = cloud.size();
  if (cloud.intensity.size() == n && cloud.rgb.size() == n && cloud.temperature_k.size() == n &&
      cloud.thermal_counts.size() == n) {
    return;
  }
  throw InputError("cannot draw the cloud: its vectors differ in length from its " +
                   std::to_string(n) + " points");
}

}  // namespace

void DrawOptions::Check() const {
  const OptionCheck check("picture");
  check.Require(width >= 16 && width <= 8000, "width", width, "16 to 8000 px");
  check.Require(height >= 16 && height <= 8000, "height", height, "16 to 8000 px");
  check.Require(field_of_view_deg >= 10 && field_of_view_deg <= 150, "field_of_view_deg",
                field_of_view_deg, "10 to 150 degrees");
  check.Require(point_size > 0 && point_size <= 100, "point_size", point_size,
                "above 0, up to 100");
}

cv::Mat DrawCloud(const RgbdtCloud& cloud, CloudColour colour, const DrawOptions& options) {
  options.Check();
  CheckCloud(cloud);
  const PointColours colours = ColourPoints(cloud, colour, options.white_background);
  const Viewpoint viewpoint = ChooseViewpoint(cloud, options);
  const cv::Size size(options.width * kSupersampling, options.height * kSupersampling);
  Canvas canvas{Background(size, options.white_background),
                cv::Mat(size, CV_32FC1, cv::Scalar(kNoDepth))};
  std::vector<Splat> splats = Project(cloud, colours, viewpoint, options);
  GrowSparse(size, &splats);
  DrawSplats(splats, &canvas);
  CloseHoles(&canvas);
  Shade(&canvas);
  cv::Mat picture;
  cv::resize(canvas.bgr, picture, {options.width, options.height}, 0, 0, cv::INTER_AREA);
  DrawLegend(colours.scale, options.white_background, &picture);
  if (options.notes) {
    DrawCaption(options, colour, colours.coloured, &picture);
    DrawAxes(viewpoint, options.white_background, &picture);
  }
  return picture;
}

cv::Mat DrawSideBySide(const RgbdtCloud& cloud, const DrawOptions& options) {
  constexpr int kGap = 8;  // [px]
  const cv::Mat rgb = DrawCloud(cloud, CloudColour::kRgb, options);
  const cv::Mat gap(options.height, kGap, CV_8UC3,
                    cv::Scalar::all(options.white_background ? 255 : 0));
  const cv::Mat thermal = DrawCloud(cloud, CloudColour::kThermal, options);
  cv::Mat both;
  cv::hconcat(std::vector<cv::Mat>{rgb, gap, thermal}, both);
  return both;
}

}  // namespace rgbdt
