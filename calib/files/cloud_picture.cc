#include "calib/files/cloud_picture.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "calib/files/cloud_colours.h"
#include "calib/files/point_radius.h"
#include "calib/model/errors.h"

namespace rgbdt {
namespace {

// Drawn so many times larger and averaged: smooth edges.
constexpr int kSupersampling = 2;
constexpr float kNoDepth = std::numeric_limits<float>::infinity();

/// Where the picture is taken from.
struct Viewpoint {
  Eigen::Matrix3d view_from_lidar;  // rotation: x right, y down, z into the picture
  Eigen::Vector3d eye;
  double focal = 0;  // [px]
  double cx = 0, cy = 0;

  Eigen::Vector3d operator*(const Eigen::Vector3d& point) const {
    return view_from_lidar * (point - eye);
  }
};

Viewpoint LookAt(const Eigen::Vector3d& eye, const Eigen::Vector3d& target,
                 const DrawOptions& options) {
  const Eigen::Vector3d forward = (target - eye).normalized();
  Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ());
  if (right.norm() < 1e-6) right = -Eigen::Vector3d::UnitY();  // straight down or up
  right.normalize();
  Viewpoint viewpoint;
  viewpoint.view_from_lidar << right.transpose(), forward.cross(right).transpose(),
      forward.transpose();
  viewpoint.eye = eye;
  const int width = options.width * kSupersampling, height = options.height * kSupersampling;
  viewpoint.focal = 0.5 * width / std::tan(0.5 * options.field_of_view_deg * M_PI / 180);
  viewpoint.cx = 0.5 * (width - 1);
  viewpoint.cy = 0.5 * (height - 1);
  return viewpoint;
}

// The points that matter for framing: those with colour, or all where hardly any has.
std::vector<Eigen::Vector3d> Subject(const RgbdtCloud& cloud, const PointColours& colours) {
  std::vector<Eigen::Vector3d> coloured, all;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!cloud.points[i].allFinite()) continue;
    all.emplace_back(cloud.points[i].cast<double>());
    if (colours.coloured[i]) coloured.push_back(all.back());
  }
  return coloured.size() >= 50 ? coloured : all;
}

double Percentile(std::vector<double> values, double fraction) {
  const auto k = static_cast<std::ptrdiff_t>(fraction * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + k, values.end());
  return values[static_cast<std::size_t>(k)];
}

Eigen::Vector3d Middle(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d middle;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    values.reserve(points.size());
    for (const Eigen::Vector3d& point : points) values.push_back(point[axis]);
    middle[axis] = Percentile(values, 0.5);
  }
  return middle;
}

// The nearer part: what people look at stands in front of the walls.
std::vector<Eigen::Vector3d> NearerPart(std::vector<Eigen::Vector3d> points) {
  const auto end = points.begin() + static_cast<std::ptrdiff_t>((points.size() + 1) * 6 / 10);
  std::nth_element(points.begin(), end == points.end() ? points.begin() : end, points.end(),
                   [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
                     return a.squaredNorm() < b.squaredNorm();
                   });
  points.erase(end, points.end());
  return points;
}

// Turns nothing, but zooms and shifts so that nearly all of `points` fills the picture.
void Fit(const std::vector<Eigen::Vector3d>& points, Viewpoint* viewpoint) {
  std::vector<double> xs, ys;
  for (const Eigen::Vector3d& point : points) {
    const Eigen::Vector3d p = *viewpoint * point;
    if (p.z() < 0.1) continue;
    xs.push_back(p.x() / p.z());
    ys.push_back(p.y() / p.z());
  }
  if (xs.size() < 10) return;
  const double left = Percentile(xs, 0.02), right = Percentile(xs, 0.98);
  const double top = Percentile(ys, 0.02), bottom = Percentile(ys, 0.98);
  const double width = 2 * viewpoint->cx + 1, height = 2 * viewpoint->cy + 1;
  const double zoom =
      0.88 * std::min(width / std::max(right - left, 1e-3), height / std::max(bottom - top, 1e-3));
  viewpoint->focal = std::min(zoom, 4 * viewpoint->focal);
  viewpoint->cx -= viewpoint->focal * 0.5 * (left + right);
  viewpoint->cy -= viewpoint->focal * 0.5 * (top + bottom);
}

// Somewhat behind the LIDAR, above it and to its left.
Viewpoint ChooseViewpoint(const std::vector<Eigen::Vector3d>& subject, const DrawOptions& options) {
  const Eigen::Vector3d target =
      options.look_at ? *options.look_at
                      : (subject.empty() ? Eigen::Vector3d(1, 0, 0) : Middle(NearerPart(subject)));
  if (options.eye) return LookAt(*options.eye, target, options);
  Eigen::Vector3d ahead(target.x(), target.y(), 0);
  ahead = ahead.norm() > 1e-3 ? ahead.normalized() : Eigen::Vector3d::UnitX();
  const Eigen::Vector3d left = Eigen::Vector3d::UnitZ().cross(ahead);
  const double distance = std::max(0.5, target.norm());
  const Eigen::Vector3d eye =
      distance * (-0.25 * ahead + 0.3 * left + 0.25 * Eigen::Vector3d::UnitZ());
  Viewpoint viewpoint = LookAt(eye, target, options);
  if (!options.look_at) Fit(subject, &viewpoint);
  return viewpoint;
}

/// A point as it lies in the picture.
struct Splat {
  cv::Point2d centre;  // [px]
  double radius = 0;   // [px]
  float depth = 0;     // [m]
  cv::Vec3b bgr;
};

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

// Calls visit(x, y, weight) for each pixel of a disc in a picture of `size`; weight 1 in the
// middle, near 0 at the rim.
template <typename Visit>
void VisitDisc(const Splat& splat, const cv::Size& size, Visit visit) {
  const double squared = splat.radius * splat.radius;
  const int y0 = std::max(0, static_cast<int>(std::ceil(splat.centre.y - splat.radius)));
  const int y1 =
      std::min(size.height - 1, static_cast<int>(std::floor(splat.centre.y + splat.radius)));
  for (int y = y0; y <= y1; ++y) {
    const double dy = y - splat.centre.y;
    const double half = std::sqrt(std::max(0.0, squared - dy * dy));
    const int x0 = std::max(0, static_cast<int>(std::ceil(splat.centre.x - half)));
    const int x1 = std::min(size.width - 1, static_cast<int>(std::floor(splat.centre.x + half)));
    for (int x = x0; x <= x1; ++x) {
      const double dx = x - splat.centre.x;
      visit(x, y, static_cast<float>(1.02 - (dx * dx + dy * dy) / squared));
    }
  }
}

/// The picture while it is drawn.
struct Canvas {
  cv::Mat bgr;    // CV_8UC3
  cv::Mat depth;  // CV_32FC1; infinite: background
};

// Two passes (surface splatting, Zwicker 2001, with round splats): first how near the front is;
// then the mean of all discs that belong to the front, so that range noise does not show as specks.
void DrawSplats(const std::vector<Splat>& splats, Canvas* canvas) {
  const cv::Size size = canvas->bgr.size();
  cv::Mat front(size, CV_32FC1, cv::Scalar(kNoDepth));
  for (const Splat& splat : splats) {
    VisitDisc(splat, size, [&](int x, int y, float) {
      float& depth = front.at<float>(y, x);
      depth = std::min(depth, splat.depth);
    });
  }
  cv::Mat sums(size, CV_32FC4, cv::Scalar::all(0));  // colour and weight
  cv::Mat depths(size, CV_32FC1, cv::Scalar::all(0));
  for (const Splat& splat : splats) {
    VisitDisc(splat, size, [&](int x, int y, float weight) {
      const float nearest = front.at<float>(y, x);
      if (splat.depth > nearest + 0.04f + 0.01f * nearest) return;
      sums.at<cv::Vec4f>(y, x) += weight * cv::Vec4f(splat.bgr[0], splat.bgr[1], splat.bgr[2], 1);
      depths.at<float>(y, x) += weight * splat.depth;
    });
  }
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const cv::Vec4f& sum = sums.at<cv::Vec4f>(y, x);
      if (sum[3] <= 0) continue;
      for (int c = 0; c < 3; ++c) {
        canvas->bgr.at<cv::Vec3b>(y, x)[c] = cv::saturate_cast<unsigned char>(sum[c] / sum[3]);
      }
      canvas->depth.at<float>(y, x) = depths.at<float>(y, x) / sum[3];
    }
  }
}

// Eye-dome lighting: a pixel is the darker the further its surroundings stand in front of it.
void Shade(Canvas* canvas) {
  cv::Mat logs;
  cv::log(canvas->depth, logs);
  constexpr double kStrength = 6;
  const int near = kSupersampling, far = 3 * kSupersampling;
  const int rows = logs.rows, cols = logs.cols;
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < cols; ++x) {
      if (canvas->depth.at<float>(y, x) == kNoDepth) continue;
      const float here = logs.at<float>(y, x);
      float sum = 0;
      for (const int reach : {near, far}) {
        for (int dy = -1; dy <= 1; ++dy) {
          for (int dx = -1; dx <= 1; ++dx) {
            const int ny = std::clamp(y + dy * reach, 0, rows - 1);
            const int nx = std::clamp(x + dx * reach, 0, cols - 1);
            // Bounded: one large step is to draw a line, not to blacken a surface.
            sum += std::clamp(here - logs.at<float>(ny, nx), 0.f, 0.04f);
          }
        }
      }
      const double light = std::exp(-kStrength * sum / 2);
      cv::Vec3b& pixel = canvas->bgr.at<cv::Vec3b>(y, x);
      for (int c = 0; c < 3; ++c) pixel[c] = cv::saturate_cast<unsigned char>(pixel[c] * light);
    }
  }
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
  const auto require = [](bool good, const std::string& field, double value,
                          const std::string& expected) {
    if (!good) {
      throw InputError("picture: " + field + " is " + std::to_string(value) + "; expected " +
                       expected);
    }
  };
  require(width >= 16 && width <= 8000, "width", width, "16 to 8000 px");
  require(height >= 16 && height <= 8000, "height", height, "16 to 8000 px");
  require(field_of_view_deg >= 10 && field_of_view_deg <= 150, "field_of_view_deg",
          field_of_view_deg, "10 to 150 degrees");
  require(point_size > 0 && point_size <= 100, "point_size", point_size, "above 0, up to 100");
}

cv::Mat DrawCloud(const RgbdtCloud& cloud, CloudColour colour, const DrawOptions& options) {
  options.Check();
  CheckCloud(cloud);
  const PointColours colours = ColourPoints(cloud, colour, options.white_background);
  const Viewpoint viewpoint = ChooseViewpoint(Subject(cloud, colours), options);
  const cv::Size size(options.width * kSupersampling, options.height * kSupersampling);
  Canvas canvas{cv::Mat(size, CV_8UC3, cv::Scalar::all(options.white_background ? 255 : 24)),
                cv::Mat(size, CV_32FC1, cv::Scalar(kNoDepth))};
  DrawSplats(Project(cloud, colours, viewpoint, options), &canvas);
  Shade(&canvas);
  cv::Mat picture;
  cv::resize(canvas.bgr, picture, {options.width, options.height}, 0, 0, cv::INTER_AREA);
  DrawLegend(colours.scale, options.white_background, &picture);
  if (!options.title.empty()) {
    DrawText(options.title, {20, 32}, options.white_background, &picture);
  }
  return picture;
}

}  // namespace rgbdt
