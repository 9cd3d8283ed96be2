#include "calib/solve/board_problem.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <utility>

#include "calib/model/linear_algebra.h"
#include "calib/solve/internal/board_priors.h"
#include "calib/solve/internal/view_equations.h"

namespace rgbdt {
namespace {

constexpr int kLocal = kOwnUnknowns;
using LocalMatrix = Eigen::Matrix<double, kLocal, kLocal>;
using LocalVector = Eigen::Matrix<double, kLocal, 1>;

// A view's equations with its own unknowns eliminated, and how to get these back.
struct Reduced {
  ViewInformation shared;
  OwnUnknowns own;
};

Reduced Reduce(const ViewEquations& equations, double damping) {
  const auto shared = equations.h().cols() - kLocal;
  LocalMatrix local = equations.h().topLeftCorner<kLocal, kLocal>();
  local.diagonal() *= 1 + damping;
  const Eigen::Matrix<double, kLocal, Eigen::Dynamic> coupling =
      equations.h().topRightCorner(kLocal, shared);
  Reduced out;
  out.own.by_shared = SolveSymmetric(local, coupling);
  out.own.step = SolveSymmetric(local, LocalVector(equations.g().head<kLocal>()));
  out.shared.information =
      equations.h().bottomRightCorner(shared, shared) - coupling.transpose() * out.own.by_shared;
  out.shared.gradient = equations.g().tail(shared) - coupling.transpose() * out.own.step;
  return out;
}

// Where a step leads, and its length in sigmas, squared.
struct Stepped {
  BoardState state;
  double size = 0;
};

// Where residuals lose their say as they grow, steps shrink slowly, each by the same rate as the
// one before: what all that would follow add up to is known from two of them (Aitken 1926). Where
// they even grow, off a saddle, it is ten of them.
class Stretch {
 public:
  double factor() const { return factor_; }
  // After a step of this size; 0: one to draw no conclusions from.
  void Next(double size) {
    const double rate = last_ > 0 && factor_ == 1 ? std::sqrt(size / last_) : 0;
    factor_ = rate > kLeastRate ? 1 / (1 - std::min(rate, kMostRate)) : 1;
    last_ = size;
  }
  // Of a stretched step that led astray. False: it was none.
  bool Drop() {
    const bool stretched = factor_ != 1;
    *this = Stretch();
    return stretched;
  }

 private:
  static constexpr double kLeastRate = 0.2, kMostRate = 0.9;
  double factor_ = 1;
  double last_ = 0;  // size of the step before
};

// The shared unknowns changed by x, the others as they are.
BoardState MovedBy(BoardState state, const SharedPlaces& places, const Eigen::VectorXd& x) {
  for (std::size_t c = 0; c < state.camera_from_lidar.size(); ++c) {
    state.camera_from_lidar[c] =
        Exp(x.segment<6>(SharedPlaces::Pose(c))) * state.camera_from_lidar[c];
    state.lenses[c] = WithNumbers(
        state.lenses[c], NumbersOf(state.lenses[c]) + x.segment<kLensNumbers>(places.Lens(c)));
  }
  for (int k = 0; k < kSharedUnknowns; ++k) {
    state.shared[static_cast<std::size_t>(k)] += x[places.Of(k)];
  }
  for (std::size_t i = 0; i < state.range_terms.size(); ++i) {
    state.range_terms[i] += x[places.RangeTerm(i)];
  }
  for (std::size_t l = 0; l < state.lidars.size(); ++l) {
    LidarState& lidar = state.lidars[l];
    lidar.reference_from_lidar =
        Exp(x.segment<6>(places.LidarPose(l))) * lidar.reference_from_lidar;
    for (int k = 0; k < kSharedUnknowns; ++k) {
      if (IsOfLidar(k)) lidar.shared[static_cast<std::size_t>(k)] += x[places.Of(l, k)];
    }
    for (std::size_t i = 0; i < lidar.range_terms.size(); ++i) {
      lidar.range_terms[i] += x[places.RangeTerm(l, i)];
    }
  }
  return state;
}

// A view's own unknowns, changed.
void MoveView(const LocalVector& local, std::size_t view, BoardState* state) {
  Rigid3& board = state->lidar_from_target[view];
  board = board * Exp(Vector6d(local.head<6>()));
  for (int side = 0; side < 4; ++side) {
    state->side_shift[view][static_cast<std::size_t>(side)] += local[6 + side];
  }
}

// The sides as further LIDARs see them follow from all else.
void MoveFurtherSides(const ViewEquations& equations, const LocalVector& local,
                      const Eigen::VectorXd& shared, double stretch, std::size_t view,
                      BoardState* state) {
  if (state->lidars.empty()) return;
  Eigen::VectorXd x(local.size() + shared.size());
  x << local, shared;
  for (std::size_t l = 0; l < state->lidars.size(); ++l) {
    const Eigen::Vector4d step = equations.further()[l].SideStep(x);
    for (int side = 0; side < 4; ++side) {
      state->lidars[l].side_shift[view][static_cast<std::size_t>(side)] += stretch * step[side];
    }
  }
}

// How many of the shared unknowns before this one each LIDAR has of its own.
Eigen::Index OwnOfLidar(int before) {
  Eigen::Index count = 0;
  for (int k = 0; k < before; ++k) count += IsOfLidar(k) ? 1 : 0;
  return count;
}

// All views' equations at a state, and what follows from them.
class Step {
 public:
  Step(const BoardProblem& problem, BoardState state)
      : problem_(problem), state_(std::move(state)) {
    for (std::size_t v = 0; v < problem.views.size(); ++v) {
      equations_.emplace_back(problem, state_, v);
      cost_ += equations_.back().cost();
    }
    cost_ += PriorCost(problem, state_);
    prior_ = PriorInformation(problem, state_);
  }

  double cost() const { return cost_; }

  // The step with this damping, so many times as long.
  Stepped Take(double damping, double stretch = 1) const {
    std::vector<Reduced> reduced;
    Eigen::MatrixXd h = prior_.information;
    Eigen::VectorXd g = prior_.gradient;
    for (const ViewEquations& e : equations_) {
      reduced.push_back(Reduce(e, damping));
      h += reduced.back().shared.information;
      g += reduced.back().shared.gradient;
    }
    h.diagonal() *= 1 + damping;
    const Eigen::VectorXd x = SolveSymmetric(h, g);
    Stepped stepped{MovedBy(state_, SharedPlaces(problem_), stretch * x), x.dot(h * x)};
    for (std::size_t v = 0; v < reduced.size(); ++v) {
      const LocalVector local = reduced[v].own.step - reduced[v].own.by_shared * x;
      stepped.size += local.dot(equations_[v].h().topLeftCorner<kLocal, kLocal>() * local);
      MoveView(stretch * local, v, &stepped.state);
      MoveFurtherSides(equations_[v], local, x, stretch, v, &stepped.state);
    }
    return stepped;
  }

  // All that is known here; whether it has converged is for others to say.
  BoardSolution Conclude() const {
    BoardSolution solution;
    solution.state = state_;
    Eigen::MatrixXd h = prior_.information;
    for (const ViewEquations& e : equations_) {
      Reduced reduced = Reduce(e, 0);
      solution.views.push_back(std::move(reduced.shared));
      solution.own.push_back(std::move(reduced.own));
      const LocalMatrix local =
          InverseOfSymmetric(LocalMatrix(e.h().topLeftCorner<kLocal, kLocal>()));
      solution.side_variance.push_back({local(6, 6), local(7, 7), local(8, 8), local(9, 9)});
      h += solution.views.back().information;
    }
    solution.covariance = InverseOfSymmetric(h);
    return solution;
  }

 private:
  const BoardProblem& problem_;
  BoardState state_;
  std::vector<ViewEquations> equations_;
  ViewInformation prior_;
  double cost_ = 0;
};

}  // namespace

BoardState StartOf(const BoardProblem& problem, const std::vector<Rigid3>& camera_from_lidar,
                   const std::vector<Rigid3>& reference_from_lidar) {
  BoardState state;
  state.camera_from_lidar = camera_from_lidar;
  for (const Camera& camera : problem.cameras) state.lenses.push_back(camera.lens());
  state.shared = problem.priors.Means();
  state.range_terms.assign(problem.ranges.Count(), 0);
  for (const BoardView& view : problem.views) {
    state.lidar_from_target.push_back(view.cloud.pose->sensor_from_target);
    state.side_shift.push_back({});
  }
  for (std::size_t l = 0; l < problem.lidars.size(); ++l) {
    const BoardProblem& lidar = problem.lidars[l];
    LidarState& own = state.lidars.emplace_back();
    own.reference_from_lidar = reference_from_lidar[l];
    own.shared = lidar.priors.Means();
    own.range_terms.assign(lidar.ranges.Count(), 0);
    own.side_shift.resize(problem.views.size());
  }
  return state;
}

BoardStart Part(const BoardProblem& problem, const std::vector<std::size_t>& views,
                const BoardState& state) {
  BoardStart part{{problem.target,
                   problem.cameras,
                   problem.lens_priors,
                   problem.lens_of,
                   {},
                   problem.priors,
                   problem.ranges,
                   problem.ranges_exact},
                  {state.camera_from_lidar, state.lenses, state.shared, {}, {}, state.range_terms}};
  for (const std::size_t v : views) {
    part.problem.views.push_back(problem.views[v]);
    part.start.lidar_from_target.push_back(state.lidar_from_target[v]);
    part.start.side_shift.push_back(state.side_shift[v]);
  }
  part.problem.lidars = problem.lidars;
  part.start.lidars = state.lidars;
  for (std::size_t l = 0; l < problem.lidars.size(); ++l) {
    std::vector<BoardView>& clouds = part.problem.lidars[l].views;
    std::vector<std::array<double, 4>>& shifts = part.start.lidars[l].side_shift;
    clouds.clear();
    shifts.clear();
    for (const std::size_t v : views) {
      clouds.push_back(problem.lidars[l].views[v]);
      shifts.push_back(state.lidars[l].side_shift[v]);
    }
  }
  return part;
}

BoardSolution SolveSome(const BoardProblem& problem, const BoardSolution& all,
                        const std::vector<std::size_t>& views) {
  constexpr double kNextSettled = 1e-3;  // a thirtieth of a sigma, all unknowns together
  ViewInformation sum = PriorInformation(problem, all.state);
  for (const std::size_t v : views) {
    sum.information += all.views[v].information;
    sum.gradient += all.views[v].gradient;
  }
  const Eigen::VectorXd x = SolveSymmetric(sum.information, sum.gradient);
  const BoardStart some = Part(problem, views, all.state);
  BoardState there = MovedBy(some.start, SharedPlaces(problem), x);
  for (std::size_t i = 0; i < views.size(); ++i) {
    const OwnUnknowns& own = all.own[views[i]];
    MoveView(own.step - own.by_shared * x, i, &there);
  }
  const Step step(some.problem, there);
  Stepped last = step.Take(0);
  // Steps shrink by at least this rate: what the next one would be.
  const double first = x.dot(sum.information * x);
  const double next = last.size * last.size / first;
  if (!(next < kNextSettled) && !(last.size < kNextSettled)) {
    return SolveBoards(some.problem, last.size < first ? last.state : some.start, kNextSettled);
  }
  BoardSolution solution = step.Conclude();
  solution.state = std::move(last.state);
  solution.converged = solution.covariance.allFinite();
  return solution;
}

BoardSolution SolveBoards(const BoardProblem& problem, const BoardState& start, double settled) {
  constexpr int kIterations = 100;
  double damping = 0;
  bool converged = false;
  int iterations = 0;
  Stretch stretch;
  auto here = std::make_unique<Step>(problem, start);
  for (; iterations < kIterations && !converged; ++iterations) {
    const Stepped step = here->Take(damping, stretch.factor());
    auto there = std::make_unique<Step>(problem, step.state);
    if (!(there->cost() <= here->cost() * (1 + 1e-12))) {
      if (stretch.Drop()) continue;
      damping = std::max(1e-4, 10 * damping);
      // Where not even a small step helps, this is the minimum as far as rounding tells.
      converged = std::isfinite(here->cost()) && (damping > 1e4 || step.size < settled);
      if (damping > 1e4) break;
      continue;
    }
    stretch.Next(damping > 0 ? 0 : step.size);
    damping = damping < 1e-3 ? 0 : 0.1 * damping;
    converged = step.size < settled;
    here = std::move(there);
  }
  BoardSolution solution = here->Conclude();
  // What no residual holds leaves no covariance.
  solution.converged = converged && solution.covariance.allFinite();
  solution.iterations = iterations;
  return solution;
}

bool BoardProblem::PatternIsSeen() const {
  if (!target.HasPattern()) return false;
  bool images = false;
  for (const BoardView& view : views) {
    for (const BoardImage& image : view.images) {
      if (!image.edges->corners.empty()) return true;
      images = true;
    }
  }
  return !images;
}

SharedPlaces::SharedPlaces(const BoardProblem& problem) : shared_(Pose(problem.cameras.size())) {
  Eigen::Index next = shared_ + kSharedUnknowns;
  for (std::size_t c = 0; c < problem.cameras.size(); ++c) {
    const bool own = problem.HasOwnLens(c);
    lenses_.push_back(own ? next : lenses_[problem.lens_of[c]]);
    if (own) next += kLensNumbers;
  }
  range_terms_ = next;
  count_ = next + static_cast<Eigen::Index>(problem.ranges.Count());
  for (const BoardProblem& lidar : problem.lidars) {
    lidars_.push_back(count_);
    count_ += 6 + OwnOfLidar(kSharedUnknowns) + static_cast<Eigen::Index>(lidar.ranges.Count());
  }
}

Eigen::Index SharedPlaces::Of(std::size_t lidar, int shared_unknown) const {
  if (!IsOfLidar(shared_unknown)) return Of(shared_unknown);
  return lidars_[lidar] + 6 + OwnOfLidar(shared_unknown);
}

Eigen::Index SharedPlaces::RangeTerm(std::size_t lidar, std::size_t term) const {
  return lidars_[lidar] + 6 + OwnOfLidar(kSharedUnknowns) + static_cast<Eigen::Index>(term);
}

std::array<Eigen::Index, kPoseAndLens> SharedPlaces::PoseAndLens(std::size_t camera) const {
  std::array<Eigen::Index, kPoseAndLens> out{};
  std::iota(out.begin(), out.begin() + 6, Pose(camera));
  std::iota(out.begin() + 6, out.end(), Lens(camera));
  return out;
}

PoseAndLensCovariance BoardSolution::PoseAndLens(const SharedPlaces& all,
                                                 std::size_t camera) const {
  const auto places = all.PoseAndLens(camera);
  return covariance(places, places);
}

bool HasCloud(const BoardProblem& problem, std::size_t lidar, std::size_t view) {
  return problem.lidars[lidar].views[view].cloud.pose.has_value();
}

ViewInformation InformationOf(const BoardProblem& problem, const BoardState& state,
                              std::size_t view) {
  return Reduce(ViewEquations(problem, state, view), 0).shared;
}

std::vector<ImageSideEnd> ImageSideEnds(const BoardProblem& problem, const BoardState& state,
                                        std::size_t view) {
  return ViewEquations(problem, state, view).image_side_ends();
}

RingsInView RingsOff(const BoardProblem& problem, const BoardState& state, std::size_t view) {
  const ViewEquations equations(problem, state, view);
  const LocalMatrix local = equations.h().topLeftCorner<kLocal, kLocal>();
  return {equations.rings_off(), SolveSymmetric(local, LocalMatrix(equations.of_points())).trace()};
}

Misfit MisfitOf(const BoardProblem& problem, BoardState state, std::size_t view, int camera) {
  constexpr int kIterations = 20;
  for (int i = 0; i < kIterations; ++i) {
    const ViewEquations equations(problem, state, view);
    const LocalVector step =
        SolveSymmetric(LocalMatrix(equations.h().topLeftCorner<kLocal, kLocal>()),
                       LocalVector(equations.g().head<kLocal>()));
    state.lidar_from_target[view] = state.lidar_from_target[view] * Exp(Vector6d(step.head<6>()));
    for (int side = 0; side < 4; ++side) {
      state.side_shift[view][static_cast<std::size_t>(side)] += step[6 + side];
    }
    if (step.head<6>().norm() < 1e-8) break;
  }
  const ViewInformation reduced = Reduce(ViewEquations(problem, state, view), 0).shared;
  const auto c = static_cast<std::size_t>(camera);
  const Eigen::Index at = SharedPlaces::Pose(c);
  const Matrix6d information = reduced.information.block<6, 6>(at, at);
  const Vector6d gradient = reduced.gradient.segment<6>(at);
  const auto places = SharedPlaces(problem).PoseAndLens(c);
  return {gradient.dot(SolveSymmetric(information, gradient)), information,
          reduced.information.middleRows<6>(at)(Eigen::all, places)};
}

double Misfit::Expected(const PoseAndLensCovariance& covariance) const {
  const Matrix6d gradient =
      gradient_by_calibration * covariance * gradient_by_calibration.transpose();
  return 6 + SolveSymmetric(information, gradient).trace();
}

}  // namespace rgbdt
