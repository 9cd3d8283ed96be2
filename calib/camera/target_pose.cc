#include "calib/camera/target_pose.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>

#include "calib/camera/pixel_by_point.h"
#include "calib/model/linear_algebra.h"
#include "calib/model/statistics.h"
#include "calib/model/text.h"

namespace rgbdt {
namespace {

constexpr double kSigmaFloorPx = 0.01;  // no detector is better: pixels are quantised
constexpr double kOffSigmas = 4;        // 3e-4 of good corners lie beyond it in two dimensions

using Pixels = std::vector<Eigen::Vector2d>;
using Points = std::vector<Eigen::Vector3d>;
using Jacobian = Eigen::Matrix<double, 2, 6>;

// A rotation that turns the middle of what is seen onto the axis: a fisheye's corners may lie far
// from it, even beside the camera.
std::optional<Eigen::Matrix3d> FacingFromCamera(const Points& directions) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& d : directions) middle += d;
  if (!(middle.norm() > 1e-6)) return std::nullopt;
  return RotationBetween(middle, Eigen::Vector3d::UnitZ()).toRotationMatrix();
}

std::optional<Points> Directions(const Camera& camera, const Pixels& corners) {
  Points directions;
  for (const Eigen::Vector2d& corner : corners) {
    const auto direction = camera.Unproject(corner);
    if (!direction) return std::nullopt;
    directions.push_back(*direction);
  }
  return directions;
}

std::vector<Rigid3> FromOpenCv(const cv::Mat& model, const std::vector<cv::Point2d>& seen) {
  std::vector<cv::Mat> rotations;
  std::vector<cv::Mat> translations;
  try {
    cv::solvePnPGeneric(model, seen, cv::Matx33d::eye(), cv::noArray(), rotations, translations,
                        false, cv::SOLVEPNP_IPPE);
  } catch (const cv::Exception&) {
    return {};  // corners on one line, or all in one place
  }
  std::vector<Rigid3> poses;
  for (std::size_t i = 0; i < rotations.size(); ++i) {
    const cv::Vec3d w = rotations[i];
    const cv::Vec3d t = translations[i];
    const Eigen::Vector3d axis(w[0], w[1], w[2]);
    Rigid3 pose;
    if (axis.norm() > 1e-12) pose = RotationAbout(axis, axis.norm());
    pose.translation = {t[0], t[1], t[2]};
    if (pose.rotation.coeffs().allFinite() && pose.translation.allFinite()) poses.push_back(pose);
  }
  return poses;
}

std::vector<Rigid3> FirstPoses(const Camera& camera, const Points& model, const Pixels& corners) {
  const auto directions = Directions(camera, corners);
  return directions ? PlanarPoses(model, *directions) : std::vector<Rigid3>();
}

// One pose's residuals (projected - seen) [px]; empty where a corner cannot be seen.
Pixels Residuals(const Camera& camera, const Rigid3& pose, const Points& model,
                 const Pixels& corners) {
  Pixels residuals;
  residuals.reserve(corners.size());
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto pixel = camera.Project(pose * model[i]);
    if (!pixel) return {};
    residuals.emplace_back(*pixel - corners[i]);
  }
  return residuals;
}

// Of a projected point's pixel by delta at zero: pixel by point, and point by delta = [-[p]x, I].
Jacobian PixelByDelta(const Camera& camera, const Eigen::Vector3d& p) {
  const Eigen::Matrix<double, 2, 3> by_point = PixelByPoint(camera.lens(), p);
  Jacobian out;
  out << -by_point * CrossMatrix(p), by_point;
  return out;
}

struct Normal {
  Matrix6d h = Matrix6d::Zero();
  Vector6d g = Vector6d::Zero();
};

Normal NormalEquations(const Camera& camera, const Rigid3& pose, const Points& model,
                       const Pixels& residuals, const std::vector<double>& weights) {
  Normal normal;
  for (std::size_t i = 0; i < model.size(); ++i) {
    if (weights[i] == 0) continue;
    const Jacobian j = PixelByDelta(camera, pose * model[i]);
    normal.h += weights[i] * j.transpose() * j;
    normal.g += weights[i] * j.transpose() * residuals[i];
  }
  return normal;
}

double Cost(const Pixels& residuals, const std::vector<double>& weights) {
  if (residuals.empty()) return std::numeric_limits<double>::infinity();
  double cost = 0;
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    cost += weights[i] * residuals[i].squaredNorm();
  }
  return cost;
}

// Levenberg-Marquardt with these weights; false where it starts from what cannot be seen.
bool Descend(const Camera& camera, const Points& model, const Pixels& corners,
             const std::vector<double>& weights, int iterations, Rigid3* pose) {
  Pixels residuals = Residuals(camera, *pose, model, corners);
  double cost = Cost(residuals, weights);
  if (!std::isfinite(cost)) return false;
  double damping = 1e-6;
  for (int i = 0; i < iterations; ++i) {
    const Normal normal = NormalEquations(camera, *pose, model, residuals, weights);
    Matrix6d damped = normal.h;
    damped.diagonal() *= 1 + damping;
    const Vector6d step = -SolveSymmetric(damped, normal.g);
    if (!step.allFinite()) return false;
    const Rigid3 next = Exp(step) * *pose;
    const Pixels there = Residuals(camera, next, model, corners);
    const double next_cost = Cost(there, weights);
    if (!(next_cost <= cost)) {
      damping = std::max(10 * damping, 1e-4);
      if (damping > 1e8) break;
      continue;
    }
    *pose = next;
    residuals = there;
    const bool done = cost - next_cost <= 1e-12 * cost;
    cost = next_cost;
    damping *= 0.1;
    if (done) break;
  }
  return true;
}

// Sigma of one coordinate from the median length: the median of Rayleigh's distribution is 1.1774.
double ScaleOf(const Pixels& residuals) {
  std::vector<double> lengths;
  for (const Eigen::Vector2d& r : residuals) lengths.push_back(r.norm());
  return std::max(Median(std::move(lengths)) / 1.1774, kSigmaFloorPx);
}

struct Fit {
  Rigid3 pose;
  std::vector<double> weights;  // 1: used, 0: left out
  double sigma = 0;             // [px]
  double cost = 0;              // sum of squared residuals, robust: to compare two fits with
};

// What a wrong corner adds to the comparison is bounded.
double BoundedCost(const Pixels& residuals, double sigma) {
  double cost = 0;
  for (const Eigen::Vector2d& r : residuals) {
    cost += std::min(r.squaredNorm(), kOffSigmas * kOffSigmas * sigma * sigma);
  }
  return cost;
}

double SigmaOfUsed(const Pixels& residuals, const std::vector<double>& weights) {
  double used = 0;
  for (const double w : weights) used += w;
  const double freedom = std::max(1.0, 2 * used - 6);
  return std::max(std::sqrt(Cost(residuals, weights) / freedom), kSigmaFloorPx);
}

std::optional<Fit> Refine(const Camera& camera, const Points& model, const Pixels& corners,
                          const Rigid3& first) {
  Fit fit;
  fit.pose = first;
  fit.weights.assign(model.size(), 1.0);
  if (!Descend(camera, model, corners, fit.weights, 10, &fit.pose)) return std::nullopt;
  for (int i = 0; i < 12; ++i) {  // Cauchy: its usual 2.385 sigma
    const Pixels residuals = Residuals(camera, fit.pose, model, corners);
    const double c = 2.385 * ScaleOf(residuals);
    for (std::size_t k = 0; k < model.size(); ++k) {
      fit.weights[k] = 1 / (1 + residuals[k].squaredNorm() / (c * c));
    }
    if (!Descend(camera, model, corners, fit.weights, 3, &fit.pose)) return std::nullopt;
  }
  fit.sigma = ScaleOf(Residuals(camera, fit.pose, model, corners));
  for (int i = 0; i < 5; ++i) {  // which are left out settles after one or two
    const Pixels residuals = Residuals(camera, fit.pose, model, corners);
    for (std::size_t k = 0; k < model.size(); ++k) {
      fit.weights[k] = residuals[k].norm() <= kOffSigmas * fit.sigma ? 1.0 : 0.0;
    }
    if (!Descend(camera, model, corners, fit.weights, 20, &fit.pose)) return std::nullopt;
    fit.sigma = SigmaOfUsed(Residuals(camera, fit.pose, model, corners), fit.weights);
  }
  fit.cost = BoundedCost(Residuals(camera, fit.pose, model, corners), fit.sigma);
  return fit;
}

bool SamePose(const Rigid3& a, const Rigid3& b) {
  return RotationDistance(a, b) < 1e-6 &&
         (a.translation - b.translation).norm() < 1e-6 * a.translation.norm();
}

// Correlated errors of neighbouring corners inflate the covariance: the sum of the residuals'
// autocorrelation over the grid, lags weighed by Bartlett's triangle (Newey and West 1987). What
// the pose itself has taken up of them is not in the residuals, so it is rather too small.
double InflationOf(const Target& target, const Pixels& residuals,
                   const std::vector<double>& weights) {
  constexpr int kLags = 4;
  const int columns = target.corners_x();
  const int rows = target.corners_y();
  const auto at = [&](int x, int y) { return static_cast<std::size_t>(y * columns + x); };
  double alone = 0;
  double count = 0;
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    alone += weights[i] * residuals[i].squaredNorm();
    count += weights[i];
  }
  if (!(alone > 0)) return 1;
  double sum = 1;
  for (int dy = 0; dy < std::min(kLags, rows); ++dy) {
    for (int dx = dy == 0 ? 1 : 1 - kLags; dx < kLags; ++dx) {
      double together = 0;
      for (int y = 0; y + dy < rows; ++y) {
        for (int x = std::max(0, -dx); x + std::max(0, dx) < columns; ++x) {
          const std::size_t i = at(x, y);
          const std::size_t k = at(x + dx, y + dy);
          together += weights[i] * weights[k] * residuals[i].dot(residuals[k]);
        }
      }
      const double weight =
          (1 - std::abs(dx) / static_cast<double>(kLags)) * (1 - dy / static_cast<double>(kLags));
      sum += 2 * weight * together / alone;  // of both directions
    }
  }
  return std::sqrt(std::clamp(sum, 1.0, 0.25 * count));
}

// The corners that were seen: what is fitted.
struct Seen {
  Points model;
  Pixels corners;
  std::vector<std::size_t> index;  // of all of the target's
};

Seen SeenOf(const Target& target, const Pixels& corners) {
  Seen seen;
  const Points model = target.InnerCorners();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (!IsSeen(corners[i])) continue;
    seen.model.push_back(model[i]);
    seen.corners.push_back(corners[i]);
    seen.index.push_back(i);
  }
  return seen;
}

// Values of those seen among all of the target's corners, the others' being `unseen`.
template <typename T>
std::vector<T> Among(const Target& target, const Seen& seen, const std::vector<T>& values,
                     const T& unseen) {
  std::vector<T> all(static_cast<std::size_t>(target.corners_x() * target.corners_y()), unseen);
  for (std::size_t i = 0; i < values.size(); ++i) all[seen.index[i]] = values[i];
  return all;
}

std::optional<CornerPose> ToCornerPose(const Camera& camera, const Target& target, const Seen& seen,
                                       const Fit& fit, double most_off) {
  const auto off = std::count(fit.weights.begin(), fit.weights.end(), 0.0);
  if (static_cast<double>(off) > most_off * static_cast<double>(seen.model.size())) {
    return std::nullopt;
  }
  const Pixels residuals = Residuals(camera, fit.pose, seen.model, seen.corners);
  const Normal normal = NormalEquations(camera, fit.pose, seen.model, residuals, fit.weights);
  const auto inverse = InverseOfPositive(normal.h);
  if (!inverse) return std::nullopt;
  CornerPose out;
  out.pose.sensor_from_target = fit.pose;
  const std::vector<double> weights = Among(target, seen, fit.weights, 0.0);
  const Eigen::Vector2d none = Eigen::Vector2d::Zero();
  out.inflation = InflationOf(target, Among(target, seen, residuals, none), weights);
  out.pose.covariance = std::pow(out.inflation * fit.sigma, 2) * *inverse;
  if (!out.pose.covariance.allFinite()) return std::nullopt;
  out.pose.covariance = 0.5 * (out.pose.covariance + out.pose.covariance.transpose()).eval();
  out.corner_sigma_px = fit.sigma;
  for (const double w : weights) out.used.push_back(w != 0);
  return out;
}

}  // namespace

// From where the points' rays cut a plane before the camera.
std::vector<Rigid3> PlanarPoses(const Points& model, const Points& directions) {
  const auto facing_from_camera = FacingFromCamera(directions);
  if (!facing_from_camera) return {};
  std::vector<cv::Point2d> seen;
  cv::Mat points(static_cast<int>(model.size()), 1, CV_64FC3);
  for (std::size_t i = 0; i < model.size(); ++i) {
    const Eigen::Vector3d d = *facing_from_camera * directions[i];
    if (d.z() < 0.05) return {};
    seen.emplace_back(d.x() / d.z(), d.y() / d.z());
    points.at<cv::Vec3d>(static_cast<int>(i)) = {model[i].x(), model[i].y(), model[i].z()};
  }
  Rigid3 camera_from_facing;
  camera_from_facing.rotation = Eigen::Quaterniond(facing_from_camera->transpose());
  std::vector<Rigid3> poses = FromOpenCv(points, seen);
  for (Rigid3& pose : poses) pose = camera_from_facing * pose;
  return poses;
}

bool RightHanded(const Target& target, const Pixels& corners) {
  const auto columns = static_cast<std::size_t>(target.corners_x());
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();  // of columns and rows
  double seen = 0;
  const auto at = [&](std::size_t i) {
    const std::size_t row = i / columns;
    return Eigen::Vector2d(static_cast<double>(i % columns), static_cast<double>(row));
  };
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (!IsSeen(corners[i])) continue;
    middle += at(i);
    seen += 1;
  }
  middle /= seen;
  // Of the affine map that fits best, times what is positive.
  Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (IsSeen(corners[i])) sum += corners[i] * (at(i) - middle).transpose();
  }
  return sum.determinant() > 0;
}

std::optional<CornerPose> PoseFromCorners(const Camera& camera, const Target& target,
                                          const std::vector<Eigen::Vector2d>& corners,
                                          double most_off, const Eigen::Vector3d& bow_m) {
  if (corners.size() != target.InnerCorners().size()) return std::nullopt;
  Seen seen = SeenOf(target, corners);
  if (seen.corners.size() < 4 || !RightHanded(target, corners)) return std::nullopt;
  const std::vector<Rigid3> by_plane = FirstPoses(camera, seen.model, seen.corners);
  for (Eigen::Vector3d& point : seen.model) {
    point.z() = target.BowFactors(point.head<2>()).dot(bow_m);
  }
  std::vector<Fit> fits;
  for (const Rigid3& first : by_plane) {
    const auto fit = Refine(camera, seen.model, seen.corners, first);
    if (fit) fits.push_back(*fit);
  }
  if (fits.empty()) return std::nullopt;
  const auto less = [](const Fit& a, const Fit& b) { return a.cost < b.cost; };
  std::stable_sort(fits.begin(), fits.end(), less);
  auto out = ToCornerPose(camera, target, seen, fits.front(), most_off);
  if (!out) return std::nullopt;
  out->second_pose_chi2 = std::numeric_limits<double>::infinity();
  if (fits.size() > 1 && !SamePose(fits[0].pose, fits[1].pose)) {
    const double sigma = fits[0].sigma;
    const Pixels second = Residuals(camera, fits[1].pose, seen.model, seen.corners);
    out->second_pose_chi2 = (BoundedCost(second, sigma) - fits[0].cost) / (sigma * sigma);
  }
  return out;
}

std::string WhyNoFlatBoard(const Camera& camera) {
  const std::string lens = WhyLensIsUnlikely(camera);
  return "the checkerboard's corners do not fit a flat board; check the lens in the rig" +
         (lens.empty() ? "" : ": " + lens);
}

std::string WhyLensIsUnlikely(const Camera& camera) {
  std::string why;
  const Lens& lens = camera.lens();
  // A centre lies near the image's middle, a focal length hardly ever is half of the image.
  const auto near_middle = [](double value, int size) {
    return std::abs(value - 0.5 * size) < 0.125 * size;
  };
  const auto add = [&](const char* axis, double focal, double centre, int size) {
    if (near_middle(centre, size) || !near_middle(focal, size)) return;
    if (!why.empty()) why += "; ";
    why += Format(
        "c%s = %.0f is far from the middle of the image, %dx%d; were f%s and c%s "
        "exchanged?",
        axis, centre, camera.width(), camera.height(), axis, axis);
  };
  add("x", lens.fx, lens.cx, camera.width());
  add("y", lens.fy, lens.cy, camera.height());
  return why;
}

}  // namespace rgbdt
