#include "calib/camera/internal/intrinsics_start.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "calib/camera/lens.h"
#include "calib/model/linear_algebra.h"
#include "calib/model/statistics.h"

namespace rgbdt {
namespace {

constexpr double kDegree = M_PI / 180;

using Points = std::vector<Eigen::Vector3d>;
using Pixels = std::vector<Eigen::Vector2d>;

// H with direction ~ H (x, y, 1) for the points (x, y, 0), up to scale: the direct linear
// transformation, with directions in place of pixels so that any angle off the axis will do.
Eigen::Matrix3d Homography(const Points& points, const Points& directions) {
  double scale = 0;  // all of A's columns alike
  for (const Eigen::Vector3d& p : points) scale = std::max(scale, p.head<2>().norm());
  Eigen::Matrix<double, 9, 9> normal = Eigen::Matrix<double, 9, 9>::Zero();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::RowVector3d x(points[i].x() / scale, points[i].y() / scale, 1);
    const Eigen::Vector3d d = directions[i].normalized();
    Eigen::Matrix<double, 3, 9> rows;  // d cross (H x) = 0, H by rows
    rows << 0 * x, -d.z() * x, d.y() * x, d.z() * x, 0 * x, -d.x() * x, -d.y() * x, d.x() * x,
        0 * x;
    normal += rows.transpose() * rows;
  }
  const Eigen::Matrix<double, 9, 1> h = EigensystemOf(normal).vectors.col(0);
  Eigen::Matrix3d homography;
  homography << h.segment<3>(0).transpose(), h.segment<3>(3).transpose(),
      h.segment<3>(6).transpose();
  homography.leftCols<2>() /= scale;
  return homography;
}

Lens IdealLens(const IntrinsicsInput& input, double focal) {
  Lens lens;
  lens.model = input.choice == LensChoice::kFisheye ? Lens::Model::kFisheye : Lens::Model::kPinhole;
  lens.fx = lens.fy = focal;
  lens.cx = 0.5 * (input.width - 1);
  lens.cy = 0.5 * (input.height - 1);
  return lens;
}

// Where pixels look through a lens without distortion; nothing where one lies beyond its field.
std::optional<Points> Directions(const Lens& lens, const Pixels& pixels) {
  Points directions;
  directions.reserve(pixels.size());
  for (const Eigen::Vector2d& pixel : pixels) {
    const Eigen::Vector2d at((pixel.x() - lens.cx) / lens.fx, (pixel.y() - lens.cy) / lens.fy);
    if (lens.model == Lens::Model::kPinhole) {
      directions.emplace_back(at.x(), at.y(), 1);
      continue;
    }
    const double theta = at.norm();
    if (theta > 0.95 * M_PI) return std::nullopt;
    const double sine = theta > 1e-9 ? std::sin(theta) / theta : 1;
    directions.emplace_back(at.x() * sine, at.y() * sine, std::cos(theta));
  }
  return directions;
}

double Rms(const Lens& lens, const Rigid3& pose, const Points& points, const Pixels& pixels) {
  double sum = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d p = pose * points[i];
    if (lens.model == Lens::Model::kPinhole && p.z() <= 1e-6) {
      return std::numeric_limits<double>::infinity();
    }
    Eigen::Vector2d pixel;
    ProjectUnchecked(lens, p.x(), p.y(), p.z(), &pixel.x(), &pixel.y());
    sum += (pixel - pixels[i]).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(points.size()));
}

// All views' poses through this lens; returns the median of their RMS, infinite where most fail.
double TryLens(const IntrinsicsInput& input, const Points& points, IntrinsicsStart* start) {
  std::vector<double> rms;
  start->poses.clear();
  for (const IntrinsicsView& view : input.views) {
    start->poses.emplace_back();
    rms.push_back(std::numeric_limits<double>::infinity());
    const auto directions = Directions(start->lens, view.corners);
    if (!directions) continue;
    const auto pose = PoseFromDirections(points, *directions);
    if (!pose) continue;
    const double error = Rms(start->lens, *pose, points, view.corners);
    if (!std::isfinite(error)) continue;
    rms.back() = error;
    start->poses.back() = pose;
  }
  return rms.empty() ? std::numeric_limits<double>::infinity() : Median(rms);
}

// Zhang (2000), section 3.1, with square pixels and the principal point in the middle: what is left
// of his B is 1 / f^2, one unknown and two equations a view.
std::optional<double> ZhangFocal(const IntrinsicsInput& input, const Points& points) {
  const double unit = std::hypot(input.width, input.height);
  double pp = 0;
  double pq = 0;
  for (const IntrinsicsView& view : input.views) {
    Eigen::Matrix3d h = Homography(points, *Directions(IdealLens(input, unit), view.corners));
    h /= 0.5 * (h.col(0).norm() + h.col(1).norm());
    const double p1 = h.col(0).head<2>().dot(h.col(1).head<2>());
    const double q1 = h(2, 0) * h(2, 1);
    const double p2 = h.col(0).head<2>().squaredNorm() - h.col(1).head<2>().squaredNorm();
    const double q2 = h(2, 0) * h(2, 0) - h(2, 1) * h(2, 1);
    pp += p1 * p1 + p2 * p2;
    pq += p1 * q1 + p2 * q2;
  }
  const double ratio = -pq / pp;  // (unit / f)^2
  if (!(ratio > 1e-4) || !(ratio < 1e4)) return std::nullopt;
  return unit / std::sqrt(ratio);
}

std::vector<double> FocalsToTry(const IntrinsicsInput& input, const Points& points) {
  std::vector<double> focals;
  if (input.choice != LensChoice::kFisheye) {
    if (const auto focal = ZhangFocal(input, points)) focals.push_back(*focal);
  }
  const auto [least, greatest] = FocalRange(input.choice, input.width, input.height);
  for (double focal = greatest; focal > least; focal /= 1.15) focals.push_back(focal);
  return focals;
}

}  // namespace

// The pose whose columns r1 r2 t are the homography's, made orthonormal.
std::optional<Rigid3> PoseFromDirections(const Points& points, const Points& directions) {
  Eigen::Matrix3d h = Homography(points, directions);
  h /= 0.5 * (h.col(0).norm() + h.col(1).norm());
  if (!h.allFinite()) return std::nullopt;
  double in_front = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    in_front += directions[i].dot(h * Eigen::Vector3d(points[i].x(), points[i].y(), 1));
  }
  if (in_front < 0) h = -h;
  Eigen::Matrix3d axes;
  axes << h.col(0), h.col(1), h.col(0).cross(h.col(1));
  const Eigen::Matrix3d rotation = NearestOrthogonal(axes);
  if (rotation.determinant() < 0) return std::nullopt;
  if (rotation.col(2).dot(h.col(2)) <= 0) return std::nullopt;  // seen from behind: mirrored
  return Rigid3{Eigen::Quaterniond(rotation), h.col(2)};
}

std::pair<double, double> FocalRange(LensChoice choice, int width, int height) {
  const double half_diagonal = 0.5 * std::hypot(width, height);
  const double least = choice == LensChoice::kFisheye ? half_diagonal / (125 * kDegree)
                                                      : half_diagonal / std::tan(78 * kDegree);
  return {least, half_diagonal / std::tan(2 * kDegree)};
}

IntrinsicsStart GuessIntrinsics(const IntrinsicsInput& input) {
  const Points points = input.target.InnerCorners();
  IntrinsicsStart best;
  best.poses.resize(input.views.size());
  double least = std::numeric_limits<double>::infinity();
  for (const double focal : FocalsToTry(input, points)) {
    IntrinsicsStart start{IdealLens(input, focal), {}};
    const double error = TryLens(input, points, &start);
    if (!(error < least)) continue;
    least = error;
    best = std::move(start);
  }
  return best;
}

}  // namespace rgbdt
