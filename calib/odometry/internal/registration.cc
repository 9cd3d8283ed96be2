#include "calib/odometry/internal/registration.h"

#include <algorithm>
#include <cmath>

#include "calib/model/linear_algebra.h"
#include "calib/odometry/internal/degeneracy.h"

namespace rgbdt::odometry {
namespace {

constexpr int kMostIterations = 25;
constexpr double kOnPlane = 0.1;       // [m]
constexpr double kNearPlane = 0.03;    // [m]
constexpr double kLeastScale = 0.003;  // [m] of distances
constexpr double kSettled = 0.02;      // [m] after smaller steps points keep their planes
constexpr double kDone = 3e-4;         // [m], of the lever for turns
// Before a sweep has found its place its points are farther from their planes than these scatter,
// which does not make what the planes tell less: [m]
constexpr double kMostScatter = 0.02;
constexpr double kAccelerationLasts = 0.1;  // [s]
// A beam as wide as most that grazes a plane comes back from its near end: [rad]
constexpr double kGrazing = 0.05;
constexpr int kMostSearches = 10;    // iterations in which points look for their planes
constexpr std::size_t kFewest = 50;  // matched points

/// A point on a plane: r = normal . (point - mean), with its derivative by a small motion of the
/// LIDAR in the sweep's middle.
struct Residual {
  Match match;
  Eigen::Vector3d in_middle = Eigen::Vector3d::Zero();
  double seconds = 0;
  double distance = 0;
  Vector6d slope = Vector6d::Zero();
  double weight = 0;
  double common = 0;  // variance of what the plane is off by, for all of its points [m^2]
};

struct Normal {
  Matrix12d h = Matrix12d::Zero();
  Vector12d g = Vector12d::Zero();
};

class Solver {
 public:
  Solver(const TimedSweep& sweep, const PlaneMap& map, const Motion& before, const Motion& start,
         Untold untold, const OdometryOptions& options)
      : sweep_(sweep), map_(map), before_(before), untold_(untold), options_(options) {
    result_.motion = start;
    matches_.resize(sweep.selected.size());
  }

  Registration Solve() {
    bool settled = false;
    double step = 0;
    for (int i = 0; i < kMostIterations && !result_.converged; ++i) {
      Evaluate(!settled);
      if (result_.matched < kFewest) return result_;
      if (untold_ == Untold::kFromTheBeginning && (i == 0 || i == 3)) FindDegenerate(kMostScatter);
      step = Step();
      ++result_.iterations;
      if (settled && step < kDone) {
        result_.converged = true;
      }
      settled = settled || step < kSettled || i + 1 == kMostSearches;
    }
    // Robust weights may go on moving it by millimetres: less than it is known to.
    result_.converged = result_.converged || (settled && step < kSettled);
    Evaluate(false);
    FindDegenerate(result_.converged ? scale_ : kMostScatter);
    for (int i = 0; i < 2; ++i) {
      Step();
      Evaluate(false);
    }
    result_.motion.covariance = Covariance();
    return result_;
  }

 private:
  void Evaluate(bool match);
  void Weigh(bool scale);
  double WeightOf(const Residual& r, double scatter) const;
  Normal Data() const;
  Vector12d Off() const;
  void Move(const Vector12d& step);
  struct Told {
    Eigen::MatrixXd columns, numbers;
  };
  Told ToldDirections() const;
  double Step();
  Matrix12d Covariance() const;
  void FindDegenerate(double most_scatter);

  const TimedSweep& sweep_;
  const PlaneMap& map_;
  const Motion& before_;
  Untold untold_;
  const OdometryOptions& options_;
  Directions directions_;
  std::vector<Match> matches_;
  std::vector<Residual> residuals_;
  double scale_ = 1;
  Registration result_;
};

void Solver::Evaluate(bool match) {
  const SweepMotion motion(result_.motion.world_from_lidar, result_.motion.velocity,
                           sweep_.seconds);
  residuals_.clear();
  for (std::size_t i = 0; i < sweep_.selected.size(); ++i) {
    const TimedPoint& p = sweep_.selected[i];
    const Eigen::Vector3d in_middle = motion.InMiddle(p);
    const Eigen::Vector3d in_world = motion.InWorld(in_middle);
    if (match) matches_[i] = map_.Find(in_world);
    if (matches_[i].plane == nullptr) continue;
    const Plane& plane = *matches_[i].plane;
    const Eigen::Vector3d normal = motion.rotation().transpose() * plane.normal;
    if (match && std::abs(normal.dot(in_middle)) < kGrazing * in_middle.norm()) {
      matches_[i].plane = nullptr;
      continue;
    }
    Residual r;
    r.match = matches_[i];
    r.in_middle = in_middle;
    r.seconds = p.seconds;
    r.distance = plane.normal.dot(in_world - plane.mean);
    r.slope << in_middle.cross(normal), normal;
    residuals_.push_back(r);
  }
  result_.matched = residuals_.size();
  if (!residuals_.empty()) Weigh(match);
}

// What a plane is off by is common to its points: together they tell no more than that lets them.
void Solver::Weigh(bool scale) {
  std::vector<double> distances;
  double squared = 0;
  std::size_t on_plane = 0;
  result_.near = 0;
  for (const Residual& r : residuals_) {
    distances.push_back(std::abs(r.distance));
    squared += r.in_middle.squaredNorm();
    if (distances.back() < kOnPlane) ++on_plane;
    if (distances.back() < kNearPlane) ++result_.near;
  }
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  result_.residual_m = *middle;
  result_.fit = static_cast<double>(on_plane) / static_cast<double>(residuals_.size());
  result_.lever_m = std::sqrt(squared / static_cast<double>(residuals_.size()));
  if (scale) scale_ = std::max(kLeastScale, 1.4826 * *middle);
  std::array<std::vector<float>, PlaneMap::kLevels> counts;
  for (std::size_t level = 0; level < counts.size(); ++level) {
    counts[level].resize(map_.size(static_cast<int>(level)));
  }
  const auto count = [&](const Match& m) -> float& {
    return counts[static_cast<std::size_t>(m.level)][m.voxel];
  };
  for (const Residual& r : residuals_) count(r.match) += 1;
  for (Residual& r : residuals_) {
    const Plane& plane = *r.match.plane;
    r.common = count(r.match) * plane.mean_variance;
    r.weight = WeightOf(r, scale_);
  }
}

// Of a point whose own scatter is this [m].
double Solver::WeightOf(const Residual& r, double scatter) const {
  const double whitened = r.distance / (2 * scale_);
  return 1 / ((scatter * scatter + r.common) * (1 + whitened * whitened));
}

// Each point's slope by the velocity is that by the motion times the point's time, so three sums of
// 6 x 6 make up the whole.
Normal Solver::Data() const {
  Matrix6d h0 = Matrix6d::Zero(), h1 = Matrix6d::Zero(), h2 = Matrix6d::Zero();
  Vector6d g0 = Vector6d::Zero(), g1 = Vector6d::Zero();
  for (const Residual& r : residuals_) {
    const Vector6d weighted = r.weight * r.slope;
    const Matrix6d outer = weighted * r.slope.transpose();
    h0 += outer;
    h1 += r.seconds * outer;
    h2 += r.seconds * r.seconds * outer;
    g0 += r.distance * weighted;
    g1 += r.seconds * r.distance * weighted;
  }
  Normal normal;
  normal.h << h0, h1, h1, h2;
  normal.g << g0, g1;
  return normal;
}

Vector12d Solver::Off() const {
  Vector12d off;
  off << Log(before_.world_from_lidar.Inverse() * result_.motion.world_from_lidar),
      result_.motion.velocity - before_.velocity;
  return off;
}

void Solver::Move(const Vector12d& step) {
  Motion& motion = result_.motion;
  motion.world_from_lidar = motion.world_from_lidar * Exp(Vector6d(step.head<6>()));
  motion.velocity += step.tail<6>();
}

// What is told of, apart from the directions that are not: columns of 12 numbers; and what takes a
// step into such columns' numbers.
Solver::Told Solver::ToldDirections() const {
  Vector6d unit;
  unit << Eigen::Vector3d::Constant(1 / result_.lever_m), Eigen::Vector3d::Ones();
  const Eigen::MatrixXd own = unit.asDiagonal() * directions_.told;
  const Eigen::MatrixXd back = directions_.told.transpose() * unit.cwiseInverse().asDiagonal();
  const Eigen::Index n = own.cols();
  Told told{Eigen::MatrixXd::Zero(12, 2 * n), Eigen::MatrixXd::Zero(2 * n, 12)};
  told.columns.topLeftCorner(6, n) = told.columns.bottomRightCorner(6, n) = own;
  told.numbers.topLeftCorner(n, 6) = told.numbers.bottomRightCorner(n, 6) = back;
  return told;
}

// Only in the directions that are told; what was known of these before without the others: of a
// corridor's direction, known to a degree, an error of metres would be taken for one across it.
// Returns how far the points go [m].
double Solver::Step() {
  const Told told = ToldDirections();
  const Normal data = Data();
  const Eigen::MatrixXd before = InverseOfSymmetric(
      Eigen::MatrixXd(told.numbers * before_.covariance * told.numbers.transpose()));
  const Eigen::MatrixXd h = told.columns.transpose() * data.h * told.columns + before;
  const Eigen::VectorXd g = told.columns.transpose() * data.g + before * (told.numbers * Off());
  const Vector12d step = -told.columns * SolveSymmetric(h, g);
  Move(step);
  const double half = 0.5 * sweep_.seconds;
  return step.segment<3>(3).norm() + result_.lever_m * step.head<3>().norm() +
         half * (step.tail<3>().norm() + result_.lever_m * step.segment<3>(6).norm());
}

Matrix12d Solver::Covariance() const {
  const Told told = ToldDirections();
  const Eigen::MatrixXd before = InverseOfSymmetric(
      Eigen::MatrixXd(told.numbers * before_.covariance * told.numbers.transpose()));
  const Eigen::MatrixXd after = InverseOfSymmetric(
      Eigen::MatrixXd(told.columns.transpose() * Data().h * told.columns + before));
  const Matrix12d rest = Matrix12d::Identity() - told.columns * told.numbers;
  return told.columns * after * told.columns.transpose() +
         rest * before_.covariance * rest.transpose();
}

void Solver::FindDegenerate(double most_scatter) {
  Information information;
  const double scatter = std::min(scale_, most_scatter);
  const Eigen::Quaterniond middle_from_world = result_.motion.world_from_lidar.rotation.conjugate();
  for (const Residual& r : residuals_) {
    information.Add({r.in_middle, WeightOf(r, scatter), r.slope, r.match, middle_from_world});
  }
  directions_ = information.Told(result_.lever_m, options_.degenerate_m);
  result_.degenerate = directions_.degenerate;
  if (result_.degenerate.cols() == 0) return;
  const Told told = ToldDirections();
  const Vector12d off = told.columns * (told.numbers * Off());
  result_.motion = before_;
  Move(off);
}

}  // namespace

Motion Predict(const Motion& before, double seconds, const OdometryOptions& options) {
  Motion after = before;
  const Vector6d way = seconds * before.velocity;
  after.world_from_lidar = before.world_from_lidar * Exp(way);
  Matrix12d onward = Matrix12d::Identity();
  onward.topLeftCorner<6, 6>() = Adjoint(Exp(Vector6d(-way)));
  onward.topRightCorner<6, 6>() = seconds * Matrix6d::Identity();
  Vector6d acceleration;
  acceleration << Eigen::Vector3d::Constant(options.turn_radps2),
      Eigen::Vector3d::Constant(options.acceleration_mps2);
  const double t = std::abs(seconds);
  const Vector6d density = kAccelerationLasts * acceleration.cwiseAbs2();
  Matrix12d noise = Matrix12d::Zero();
  noise.topLeftCorner<6, 6>().diagonal() = t * t * t / 3 * density;
  noise.topRightCorner<6, 6>().diagonal() = noise.bottomLeftCorner<6, 6>().diagonal() =
      0.5 * t * seconds * density;
  noise.bottomRightCorner<6, 6>().diagonal() = t * density;
  after.covariance = onward * before.covariance * onward.transpose() + noise;
  return after;
}

Registration Register(const TimedSweep& sweep, const PlaneMap& map, const Motion& before,
                      const Motion& start, Untold untold, const OdometryOptions& options) {
  return Solver(sweep, map, before, start, untold, options).Solve();
}

}  // namespace rgbdt::odometry
