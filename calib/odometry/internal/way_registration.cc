#include "calib/odometry/internal/way_registration.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "calib/model/linear_algebra.h"
#include "calib/odometry/internal/degeneracy.h"
#include "calib/odometry/internal/plane_residuals.h"

namespace rgbdt::odometry {
namespace {

constexpr std::size_t kTogether = 5;       // parts that are judged together
constexpr int kWhileItGrows = 3;           // iterations
constexpr std::size_t kGrowTogether = 30;  // parts that move meanwhile, the newest
constexpr double kGrowing = 0.1;           // [m] the least width of weights meanwhile
constexpr int kMostIterations = 25;
constexpr int kMostSearches = 10;  // of these, in which points look for their planes
constexpr double kSettled = 0.02;  // [m] after smaller steps points keep their planes
constexpr double kDone = 3e-4;     // [m], of the lever for turns
constexpr std::size_t kFewest = 50;
constexpr double kMostScatter = 0.02;  // [m] for what is told, see registration.cc

/// H x = -g, H symmetric with blocks beside the diagonal only, of the parts that are solved for.
struct Chain {
  std::vector<Matrix12d> diagonal, below;  // below[k]: row k, column k - 1
  std::vector<Vector12d> gradient;
};

class Solver {
 public:
  Solver(const std::vector<TimedSweep>& parts, const PlaneMap& map, const Motion& before,
         Utime before_utime, double scatter_m, const OdometryOptions& options)
      : parts_(parts),
        scatter_(scatter_m),
        options_(options),
        matches_(parts.size()),
        residuals_(map) {
    first_ = Predict(before, ToSeconds(parts.front().middle - before_utime), options);
  }

  WayRegistration Solve() {
    while (way_.parts.size() < parts_.size()) {
      Grow();
      from_ = way_.parts.size() - std::min(way_.parts.size(), kGrowTogether);
      for (int i = 0; i < kWhileItGrows; ++i) {
        Evaluate(true, kGrowing);
        Step();
      }
    }
    from_ = 0;
    Registration& whole = way_.whole;
    bool settled = false;
    double step = 0;
    for (int i = 0; i < kMostIterations && !whole.converged; ++i) {
      Evaluate(!settled);
      if (whole.matched < kFewest) return way_;
      step = Step();
      ++whole.iterations;
      whole.converged = settled && step < kDone;
      settled = settled || step < kSettled || i + 1 == kMostSearches;
    }
    whole.converged = whole.converged || (settled && step < kSettled);
    Evaluate(false);
    FindWorst();
    FindCovariances();
    FindDegenerate();
    whole.motion = way_.parts.back();
    return way_;
  }

 private:
  // On from the last part.
  void Grow() {
    const std::size_t k = way_.parts.size();
    way_.parts.push_back(k == 0 ? first_ : Predict(way_.parts.back(), Between(k), options_));
    way_.selected += parts_[k].selected.size();
  }

  double Between(std::size_t k) const { return ToSeconds(parts_[k].middle - parts_[k - 1].middle); }

  void Evaluate(bool match, double least_width_m = 0) {
    residuals_.Clear();
    for (std::size_t k = from_; k < way_.parts.size(); ++k) {
      const Motion& motion = way_.parts[k];
      residuals_.Add(k, parts_[k],
                     SweepMotion(motion.world_from_lidar, motion.velocity, parts_[k].seconds),
                     match, &matches_[k]);
    }
    residuals_.Weigh(match, least_width_m);
    Registration& whole = way_.whole;
    whole.matched = residuals_.all().size();
    whole.residual_m = residuals_.median_m();
    whole.fit = residuals_.fit();
    whole.near = residuals_.near();
    whole.lever_m = residuals_.lever_m();
  }

  Chain Equations() const;
  double Step();
  void FindCovariances();
  void FindDegenerate();
  void FindWorst();

  const std::vector<TimedSweep>& parts_;
  double scatter_;  // [m]
  const OdometryOptions& options_;
  Motion first_;          // of the first part, before it is looked at
  std::size_t from_ = 0;  // which part is the first that is solved for: those before stay
  std::vector<std::vector<Match>> matches_;
  PlaneResiduals residuals_;
  WayRegistration way_;
};

// Each point's slope by the velocity is that by the pose times the point's time. From part to part
// the motion goes on, but for white acceleration.
Chain Solver::Equations() const {
  const std::vector<Motion>& motions = way_.parts;
  Chain chain;
  const std::size_t size = motions.size() - from_;
  chain.diagonal.assign(size, Matrix12d::Zero());
  chain.below = chain.diagonal;
  chain.gradient.assign(size, Vector12d::Zero());
  for (const Residual& r : residuals_.all()) {
    const double weight = residuals_.WeightOf(r, scatter_);
    Vector12d slope;
    slope << r.slope, r.seconds * r.slope;
    chain.diagonal[r.part - from_] += weight * slope * slope.transpose();
    chain.gradient[r.part - from_] += weight * r.distance * slope;
  }
  if (from_ == 0) {
    const Matrix12d known = InverseOfSymmetric(first_.covariance);
    chain.diagonal[0] += known;
    chain.gradient[0] += known * OffOf(first_, motions[0]);
  }
  for (std::size_t k = std::max<std::size_t>(1, from_); k < motions.size(); ++k) {
    const Onward onward = OnwardOf(motions[k - 1].velocity, Between(k), options_);
    const Matrix12d weight = InverseOfSymmetric(onward.noise);
    Motion expected = motions[k - 1];
    expected.world_from_lidar =
        expected.world_from_lidar * Exp(Vector6d(Between(k) * expected.velocity));
    const Vector12d off = OffOf(expected, motions[k]);
    const std::size_t own = k - from_;
    chain.diagonal[own] += weight;
    chain.gradient[own] += weight * off;
    if (k == from_) continue;  // the one before stays
    const Matrix12d back = weight * onward.transition;
    chain.diagonal[own - 1] += onward.transition.transpose() * back;
    chain.gradient[own - 1] -= back.transpose() * off;
    chain.below[own] = -back;
  }
  return chain;
}

// The chain without what is below its diagonal, each part's rows solved, one behind the other.
std::vector<Eigen::LDLT<Matrix12d>> Eliminate(Chain* chain) {
  std::vector<Eigen::LDLT<Matrix12d>> solved(chain->diagonal.size());
  for (std::size_t k = 0; k < solved.size(); ++k) {
    if (k > 0) {
      const Matrix12d carried = solved[k - 1].solve(chain->below[k].transpose());
      chain->diagonal[k] -= chain->below[k] * carried;
      chain->gradient[k] -= carried.transpose() * chain->gradient[k - 1];
    }
    solved[k].compute(chain->diagonal[k]);
  }
  return solved;
}

// Returns how far the points of the part that goes farthest go [m].
double Solver::Step() {
  Chain chain = Equations();
  const std::vector<Eigen::LDLT<Matrix12d>> solved = Eliminate(&chain);
  const std::size_t size = solved.size();
  double most = 0;
  Vector12d step = Vector12d::Zero();
  for (std::size_t k = size; k-- > 0;) {
    Vector12d right = -chain.gradient[k];
    if (k + 1 < size) right -= chain.below[k + 1].transpose() * step;
    step = solved[k].solve(right);
    Motion& motion = way_.parts[from_ + k];
    motion.world_from_lidar = motion.world_from_lidar * Exp(Vector6d(step.head<6>()));
    motion.velocity += step.tail<6>();
    most = std::max(most, step.segment<3>(3).norm() + way_.whole.lever_m * step.head<3>().norm());
  }
  return most;
}

// Of each part, all others unknown: from the last one back (Rauch, Tung and Striebel 1965).
void Solver::FindCovariances() {
  Chain chain = Equations();
  const std::vector<Eigen::LDLT<Matrix12d>> solved = Eliminate(&chain);
  Matrix12d next = Matrix12d::Zero();
  way_.so_far.resize(solved.size());
  for (std::size_t k = solved.size(); k-- > 0;) {
    Matrix12d own = solved[k].solve(Matrix12d::Identity());
    way_.so_far[k] = own;
    if (k + 1 < solved.size()) {
      const Matrix12d back = solved[k].solve(chain.below[k + 1].transpose());
      own += back * next * back.transpose();
    }
    next = own;
    way_.parts[k].covariance = own;
  }
}

void Solver::FindWorst() {
  std::vector<double> near(parts_.size(), 0);
  for (const Residual& r : residuals_.all()) {
    if (std::abs(r.distance) < kNearPlane) ++near[r.part];
  }
  way_.worst_near = 1;
  for (std::size_t from = 0; from + kTogether <= parts_.size(); ++from) {
    double found = 0, points = 0;
    for (std::size_t k = from; k < from + kTogether; ++k) {
      found += near[k];
      points += static_cast<double>(parts_[k].selected.size());
    }
    way_.worst_near = std::min(way_.worst_near, points > 0 ? found / points : 0);
  }
}

// Of the whole sweep, by a small motion of the LIDAR in the middle part.
void Solver::FindDegenerate() {
  const Rigid3 middle_from_world = way_.parts[way_.parts.size() / 2].world_from_lidar.Inverse();
  const double scatter = std::min(residuals_.scale_m(), kMostScatter);
  Information information;
  double squared = 0;
  for (const Residual& r : residuals_.all()) {
    const Rigid3 middle_from_part = middle_from_world * way_.parts[r.part].world_from_lidar;
    const Eigen::Vector3d in_middle = middle_from_part * r.in_middle;
    const Eigen::Vector3d normal = middle_from_part.rotation * Eigen::Vector3d(r.slope.tail<3>());
    Vector6d slope;
    slope << in_middle.cross(normal), normal;
    information.Add(
        {in_middle, residuals_.WeightOf(r, scatter), slope, r.match, middle_from_world.rotation});
    squared += in_middle.squaredNorm();
  }
  Registration& whole = way_.whole;
  whole.lever_m = std::sqrt(squared / static_cast<double>(residuals_.all().size()));
  whole.degenerate = information.Told(whole.lever_m, options_.degenerate_m).degenerate;
}

}  // namespace

WayRegistration RegisterWay(const std::vector<TimedSweep>& parts, const PlaneMap& map,
                            const Motion& before, Utime before_utime, double scatter_m,
                            const OdometryOptions& options) {
  return Solver(parts, map, before, before_utime, scatter_m, options).Solve();
}

}  // namespace rgbdt::odometry
