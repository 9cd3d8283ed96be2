#include "calib/files/cloud_picture.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "calib/files/cloud_colours.h"
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
    all.push_back(cloud.points[i].cast<double>());
    if (colours.coloured[i]) coloured.push_back(all.back());
  }
  return coloured.size() >= 50 ? coloured : all;
}

double Median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

Eigen::Vector3d Middle(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d middle;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const Eigen::Vector3d& point : points) values.push_back(point[axis]);
    middle[axis] = Median(values);
  }
  return middle;
}

// Share of the points that lie in the picture, clear of its rim.
double ShareInside(const std::vector<Eigen::Vector3d>& points, const Viewpoint& viewpoint) {
  std::size_t inside = 0;
  for (const Eigen::Vector3d& point : points) {
    const Eigen::Vector3d p = viewpoint * point;
    inside += p.z() > 0.1 &&
              std::abs(viewpoint.focal * p.x() / p.z()) < 0.92 * viewpoint.cx &&
              std::abs(viewpoint.focal * p.y() / p.z()) < 0.92 * viewpoint.cy;
  }
  return static_cast<double>(inside) / static_cast<double>(std::max<std::size_t>(points.size(), 1));
}

// Behind the LIDAR, above it and to its left, as far back as shows nearly everything with colour.
Viewpoint ChooseViewpoint(const std::vector<Eigen::Vector3d>& subject,
                          const DrawOptions& options) {
  const Eigen::Vector3d target =
      options.look_at ? *options.look_at
                      : (subject.empty() ? Eigen::Vector3d(1, 0, 0) : Middle(subject));
  if (options.eye) return LookAt(*options.eye, target, options);
  Eigen::Vector3d ahead(target.x(), target.y(), 0);
  ahead = ahead.norm() > 1e-3 ? ahead.normalized() : Eigen::Vector3d::UnitX();
  const Eigen::Vector3d left = Eigen::Vector3d::UnitZ().cross(ahead);
  const Eigen::Vector3d back =
      (-ahead + 0.55 * left + 0.42 * Eigen::Vector3d::UnitZ()).normalized();
  double distance = std::max(0.5, 0.7 * target.norm());
  Viewpoint viewpoint = LookAt(target + distance * back, target, options);
  for (int i = 0; i < 25 && ShareInside(subject, viewpoint) < 0.93; ++i) {
    distance *= 1.08;
    viewpoint = LookAt(target + distance * back, target, options);
  }
  return viewpoint;
}

// Angle between neighbouring beams [rad], the median over some of them.
double BeamSpacing(const RgbdtCloud& cloud) {
  constexpr std::size_t kSamples = 101;
  std::vector<Eigen::Vector3f> beams;
  beams.reserve(cloud.size());
  for (const Eigen::Vector3f& point : cloud.points) {
    if (point.allFinite() && !point.isZero(0)) beams.push_back(point.normalized());
  }
  if (beams.size() < 2) return 0.003;
  std::vector<double> spacings;
  const std::size_t step = std::max<std::size_t>(1, beams.size() / kSamples);
  for (std::size_t i = step / 2; i < beams.size(); i += step) {
    float nearest = kNoDepth;
    for (const Eigen::Vector3f& beam : beams) {
      const float squared = (beam - beams[i]).squaredNorm();
      if (squared > 1e-9f && squared < nearest) nearest = squared;  // not itself, not its double
    }
    if (std::isfinite(nearest)) spacings.push_back(std::sqrt(nearest));
  }
  return spacings.empty() ? 0.003 : std::clamp(Median(spacings), 0.0005, 0.03);
}

/// The picture while it is drawn.
struct Canvas {
  cv::Mat bgr;    // CV_8UC3
  cv::Mat depth;  // CV_32FC1; infinite: background
};

void DrawDisc(const cv::Point2d& centre, double radius, float depth, const cv::Vec3b& colour,
              Canvas* canvas) {
  const int y0 = std::max(0, static_cast<int>(std::ceil(centre.y - radius)));
  const int y1 = std::min(canvas->bgr.rows - 1, static_cast<int>(std::floor(centre.y + radius)));
  for (int y = y0; y <= y1; ++y) {
    const double dy = y - centre.y;
    const double half = std::sqrt(std::max(0.0, radius * radius - dy * dy));
    const int x0 = std::max(0, static_cast<int>(std::ceil(centre.x - half)));
    const int x1 = std::min(canvas->bgr.cols - 1, static_cast<int>(std::floor(centre.x + half)));
    float* const depths = canvas->depth.ptr<float>(y);
    cv::Vec3b* const pixels = canvas->bgr.ptr<cv::Vec3b>(y);
    for (int x = x0; x <= x1; ++x) {
      if (depth >= depths[x]) continue;
      depths[x] = depth;
      pixels[x] = colour;
    }
  }
}

void DrawPoints(const RgbdtCloud& cloud, const PointColours& colours, const Viewpoint& viewpoint,
                const DrawOptions& options, Canvas* canvas) {
  const double spacing = BeamSpacing(cloud);
  // What stands between the eye and the LIDAR would hide what the LIDAR looks at.
  const double nearest = std::max(0.1, options.eye ? 0.1 : (viewpoint * Eigen::Vector3d(0, 0, 0)).z());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!cloud.points[i].allFinite()) continue;
    const Eigen::Vector3d point = cloud.points[i].cast<double>();
    const Eigen::Vector3d p = viewpoint * point;
    if (p.z() < (colours.coloured[i] ? 0.1 : nearest)) continue;
    const double radius =
        std::clamp(0.75 * options.point_size * spacing * point.norm() * viewpoint.focal / p.z(),
                   0.6 * kSupersampling, 9.0 * kSupersampling);
    const cv::Point2d centre(viewpoint.focal * p.x() / p.z() + viewpoint.cx,
                             viewpoint.focal * p.y() / p.z() + viewpoint.cy);
    if (std::abs(centre.x) > 1e6 || std::abs(centre.y) > 1e6) continue;
    DrawDisc(centre, radius, static_cast<float>(p.z()), colours.bgr[i], canvas);
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
  DrawPoints(cloud, colours, viewpoint, options, &canvas);
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
