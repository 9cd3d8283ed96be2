#include "calib/odometry/internal/registration.h"

#include <algorithm>
#include <cmath>

#include "calib/model/linear_algebra.h"
#include "calib/odometry/internal/degeneracy.h"
#include "calib/odometry/internal/plane_residuals.h"

namespace rgbdt::odometry {
namespace {

constexpr int kMostIterations = 25;
constexpr double kSettled = 0.02;  // [m] after smaller steps points keep their planes
constexpr double kDone = 3e-4;     // [m], of the lever for turns
// Before a sweep has found its place its points are farther from their planes than these scatter,
// which does not make what the planes tell less: [m]
constexpr double kMostScatter = 0.02;
constexpr double kAccelerationLasts = 0.1;  // [s]
constexpr int kMostSearches = 10;           // iterations in which points look for their planes
constexpr std::size_t kFewest = 50;         // matched points

struct Normal {
  Matrix12d h = Matrix12d::Zero();
  Vector12d g = Vector12d::Zero();
};

class Solver {
 public:
  Solver(const TimedSweep& sweep, const PlaneMap& map, const Motion& before, const Motion& start,
         Untold untold, const OdometryOptions& options)
      : sweep_(sweep), before_(before), untold_(untold), options_(options), residuals_(map) {
    result_.motion = start;
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
    FindDegenerate(result_.converged ? residuals_.scale_m() : kMostScatter);
    for (int i = 0; i < 2; ++i) {
      Step();
      Evaluate(false);
    }
    result_.motion.covariance = Covariance();
    return result_;
  }

 private:
  void Evaluate(bool match);
  Normal Data() const;
  void Move(const Vector12d& step);
  struct Told {
    Eigen::MatrixXd columns, numbers;
  };
  Told ToldDirections() const;
  double Step();
  Matrix12d Covariance() const;
  void FindDegenerate(double most_scatter);

  const TimedSweep& sweep_;
  const Motion& before_;
  Untold untold_;
  const OdometryOptions& options_;
  Directions directions_;
  std::vector<Match> matches_;
  PlaneResiduals residuals_;
  Registration result_;
};

void Solver::Evaluate(bool match) {
  const SweepMotion motion(result_.motion.world_from_lidar, result_.motion.velocity,
                           sweep_.seconds);
  residuals_.Clear();
  residuals_.Add(0, sweep_, motion, match, &matches_);
  result_.matched = residuals_.all().size();
  if (residuals_.all().empty()) return;
  residuals_.Weigh(match);
  result_.near = residuals_.near();
  result_.residual_m = residuals_.median_m();
  result_.fit = residuals_.fit();
  result_.lever_m = residuals_.lever_m();
}

// Each point's slope by the velocity is that by the motion times the point's time, so three sums of
// 6 x 6 make up the whole.
Normal Solver::Data() const {
  Matrix6d h0 = Matrix6d::Zero(), h1 = Matrix6d::Zero(), h2 = Matrix6d::Zero();
  Vector6d g0 = Vector6d::Zero(), g1 = Vector6d::Zero();
  for (const Residual& r : residuals_.all()) {
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
  const Eigen::VectorXd g =
      told.columns.transpose() * data.g + before * (told.numbers * OffOf(before_, result_.motion));
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
  const double scatter = std::min(residuals_.scale_m(), most_scatter);
  const Eigen::Quaterniond middle_from_world = result_.motion.world_from_lidar.rotation.conjugate();
  for (const Residual& r : residuals_.all()) {
    information.Add(
        {r.in_middle, residuals_.WeightOf(r, scatter), r.slope, r.match, middle_from_world});
  }
  directions_ = information.Told(result_.lever_m, options_.degenerate_m);
  result_.degenerate = directions_.degenerate;
  if (result_.degenerate.cols() == 0) return;
  const Told told = ToldDirections();
  const Vector12d off = told.columns * (told.numbers * OffOf(before_, result_.motion));
  result_.motion = before_;
  Move(off);
}

}  // namespace

Vector12d OffOf(const Motion& expected, const Motion& motion) {
  Vector12d off;
  off << Log(expected.world_from_lidar.Inverse() * motion.world_from_lidar),
      motion.velocity - expected.velocity;
  return off;
}

Onward OnwardOf(const Vector6d& velocity, double seconds, const OdometryOptions& options) {
  Onward onward;
  onward.transition.topLeftCorner<6, 6>() = Adjoint(Exp(Vector6d(-seconds * velocity)));
  onward.transition.topRightCorner<6, 6>() = seconds * Matrix6d::Identity();
  Vector6d acceleration;
  acceleration << Eigen::Vector3d::Constant(options.turn_radps2),
      Eigen::Vector3d::Constant(options.acceleration_mps2);
  const double t = std::abs(seconds);
  const Vector6d density = kAccelerationLasts * acceleration.cwiseAbs2();
  Matrix12d& noise = onward.noise;
  noise.topLeftCorner<6, 6>().diagonal() = t * t * t / 3 * density;
  noise.topRightCorner<6, 6>().diagonal() = noise.bottomLeftCorner<6, 6>().diagonal() =
      0.5 * t * seconds * density;
  noise.bottomRightCorner<6, 6>().diagonal() = t * density;
  return onward;
}

Motion Predict(const Motion& before, double seconds, const OdometryOptions& options) {
  Motion after = before;
  after.world_from_lidar = before.world_from_lidar * Exp(Vector6d(seconds * before.velocity));
  const Onward onward = OnwardOf(before.velocity, seconds, options);
  after.covariance =
      onward.transition * before.covariance * onward.transition.transpose() + onward.noise;
  return after;
}

Registration Register(const TimedSweep& sweep, const PlaneMap& map, const Motion& before,
                      const Motion& start, Untold untold, const OdometryOptions& options) {
  return Solver(sweep, map, before, start, untold, options).Solve();
}

}  // namespace rgbdt::odometry
