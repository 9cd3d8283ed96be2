#include "calib/solve/board_problem.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "calib/camera/pixel_by_point.h"

namespace rgbdt {
namespace {

constexpr int kLocal = 10;     // a view's own unknowns: the board's pose, four side shifts
constexpr double kRobust = 3;  // sigmas; farther off, a residual counts less
constexpr double kLeastCornerPx = 0.01;

using Row6 = Eigen::Matrix<double, 1, 6>;

// Of a whitened residual squared: full weight near, then as in a Student-like tail, so that what is
// plainly wrong has next to no say.
double RobustWeight(double squared) {
  return squared <= kRobust * kRobust ? 1.0 : kRobust * kRobust / squared;
}

double RobustCost(double squared) {
  constexpr double kLimit = kRobust * kRobust;
  return squared <= kLimit ? squared : kLimit * (1 + std::log(squared / kLimit));
}

Eigen::Matrix3d Cross(const Eigen::Vector3d& p) {
  Eigen::Matrix3d m;
  m << 0, -p.z(), p.y(), p.z(), 0, -p.x(), -p.y(), p.x(), 0;
  return m;
}

Eigen::Vector2d OutwardOf(int side) {
  switch (side) {
    case 0:
      return {0, -1};
    case 1:
      return {1, 0};
    case 2:
      return {0, 1};
    default:
      return {-1, 0};
  }
}

double HalfExtent(const Target& target, int side) {
  return side % 2 == 1 ? target.width_m / 2 : target.height_m / 2;
}

// One view's normal equations: its own unknowns first, then the shared ones.
class ViewEquations {
 public:
  ViewEquations(const BoardProblem& problem, const BoardState& state, std::size_t view)
      : problem_(problem),
        view_(problem.views[view]),
        state_(state),
        lidar_from_target_(state.lidar_from_target[view]),
        side_shift_(state.side_shift[view]),
        cameras_(static_cast<int>(problem.cameras.size())),
        h_(Eigen::MatrixXd::Zero(Size(), Size())),
        g_(Eigen::VectorXd::Zero(Size())) {
    for (const BoardSight& sight : view_.sights) {
      AddCorners(sight);
      AddImageSides(sight);
    }
    AddCrossings();
    AddPlane();
    AddSidePriors();
  }

  double cost() const { return cost_; }
  const Eigen::MatrixXd& h() const { return h_; }
  const Eigen::VectorXd& g() const { return g_; }

 private:
  int Size() const { return kLocal + 6 * cameras_ + kSharedUnknowns; }
  int Shared(int unknown) const { return kLocal + 6 * cameras_ + unknown; }

  // Corners: 2 rows each over the camera's 6 and the board's 6 unknowns.
  void AddCorners(const BoardSight& sight) {
    const Camera& camera = problem_.cameras[static_cast<std::size_t>(sight.camera)];
    const Rigid3 camera_from_target =
        state_.camera_from_lidar[static_cast<std::size_t>(sight.camera)] * lidar_from_target_;
    const Eigen::Matrix3d rotation = camera_from_target.rotation.toRotationMatrix();
    const auto model = problem_.target.InnerCorners();
    const auto& seen = sight.image->corners;
    if (seen.size() != model.size()) return;
    const double sigma = kCornersAlike * std::max(kLeastCornerPx, sight.image->corner_sigma_px);
    Eigen::Matrix<double, 12, 12> h = Eigen::Matrix<double, 12, 12>::Zero();
    Eigen::Matrix<double, 12, 1> g = Eigen::Matrix<double, 12, 1>::Zero();
    for (std::size_t i = 0; i < model.size(); ++i) {
      const Eigen::Vector3d& corner = model[sight.turned ? model.size() - 1 - i : i];
      const Eigen::Vector3d p = camera_from_target * corner;
      const auto pixel = camera.Project(p);
      if (!pixel) {
        cost_ += RobustCost(1e6);
        continue;
      }
      const Eigen::Matrix<double, 2, 3> by_point = PixelByPoint(camera.lens(), p) / sigma;
      Eigen::Matrix<double, 2, 12> j;
      j << -by_point * Cross(p), by_point, -by_point * rotation * Cross(corner),
          by_point * rotation;
      const Eigen::Vector2d residual = (*pixel - seen[i]) / sigma;
      // Both coordinates together: two degrees of freedom.
      const double squared = residual.squaredNorm() / 2;
      const double weight = RobustWeight(squared);
      cost_ += 2 * RobustCost(squared);
      h.noalias() += weight * j.transpose() * j;
      g.noalias() -= weight * j.transpose() * residual;
    }
    Spread(sight.camera, h, g);
  }

  // From (camera, board) to their places among the unknowns.
  void Spread(int camera, const Eigen::Matrix<double, 12, 12>& h,
              const Eigen::Matrix<double, 12, 1>& g) {
    const int c = kLocal + 6 * camera;
    h_.block<6, 6>(c, c) += h.topLeftCorner<6, 6>();
    h_.block<6, 6>(0, 0) += h.bottomRightCorner<6, 6>();
    h_.block<6, 6>(0, c) += h.bottomLeftCorner<6, 6>();
    h_.block<6, 6>(c, 0) += h.topRightCorner<6, 6>();
    g_.segment<6>(c) += g.head<6>();
    g_.head<6>() += g.tail<6>();
  }

  void AddImageSides(const BoardSight& sight) {
    for (int i = 0; i < 4; ++i) {
      const ImageSide& side = sight.image->sides[static_cast<std::size_t>(i)];
      if (side.seen && side.curve.size() >= 2) {
        AddImageSide(sight, side, sight.turned ? (i + 2) % 4 : i);
      }
    }
  }

  // The projected side's distance from the curve at the curve's two ends.
  void AddImageSide(const BoardSight& sight, const ImageSide& side, int on_board) {
    const int c = kLocal + 6 * sight.camera;
    Eigen::Matrix<double, 2, Eigen::Dynamic> j =
        Eigen::Matrix<double, 2, Eigen::Dynamic>::Zero(2, Size());
    Eigen::Vector2d residual;
    const std::size_t last = side.curve.size() - 1;
    for (int end = 0; end < 2; ++end) {
      const Eigen::Vector2d& at = side.curve[end == 0 ? 0 : last];
      const Eigen::Vector2d& next = side.curve[end == 0 ? 1 : last - 1];
      Row6 by_camera;
      Row6 by_target;
      double by_outline = 0;
      if (!CurveEnd(sight, on_board, at, end == 0 ? next - at : at - next, &residual[end],
                    &by_camera, &by_target, &by_outline)) {
        return;
      }
      j.row(end).segment<6>(c) = by_camera;
      j.row(end).head<6>() = by_target;
      j(end, Shared(kOutlineTop + on_board)) = by_outline;
    }
    const Eigen::LDLT<Eigen::Matrix2d> ldlt(side.covariance);
    if (ldlt.info() != Eigen::Success || !(ldlt.vectorD().minCoeff() > 0)) return;
    const Eigen::Matrix2d information = ldlt.solve(Eigen::Matrix2d::Identity());
    const double squared = residual.dot(information * residual) / 2;
    const double weight = RobustWeight(squared);
    cost_ += 2 * RobustCost(squared);
    h_ += weight * j.transpose() * information * j;
    g_ -= weight * j.transpose() * information * residual;
  }

  // One end: where on the side the curve ends, and how far the projected side lies from there.
  bool CurveEnd(const BoardSight& sight, int side, const Eigen::Vector2d& at,
                const Eigen::Vector2d& along, double* residual, Row6* by_camera, Row6* by_target,
                double* by_outline) const {
    const Camera& camera = problem_.cameras[static_cast<std::size_t>(sight.camera)];
    const Rigid3 camera_from_target =
        state_.camera_from_lidar[static_cast<std::size_t>(sight.camera)] * lidar_from_target_;
    const Eigen::Matrix3d rotation = camera_from_target.rotation.toRotationMatrix();
    const auto corners = problem_.target.OutlineCorners();
    const auto s = static_cast<std::size_t>(side);
    const Eigen::Vector2d out = OutwardOf(side);
    const Eigen::Vector3d outward(out.x(), out.y(), 0);
    const Eigen::Vector3d shift =
        state_.shared[static_cast<std::size_t>(kOutlineTop + side)] * outward;
    const Eigen::Vector3d from = corners[s] + shift;
    const Eigen::Vector3d to = corners[(s + 1) % 4] + shift;
    const Eigen::Vector2d tangent = along.normalized();
    double t = 0.5;  // along the side; two Newton steps put it beside the curve's end
    for (int i = 0; i < 4; ++i) {
      const Eigen::Vector3d p = camera_from_target * Eigen::Vector3d(from + t * (to - from));
      const auto pixel = camera.Project(p);
      if (!pixel) return false;
      const Eigen::Vector2d by_t = PixelByPoint(camera.lens(), p) * rotation * (to - from);
      const double speed = tangent.dot(by_t);
      if (std::abs(speed) < 1e-6) return false;
      t += std::clamp(tangent.dot(at - *pixel) / speed, -1.0, 1.0);
    }
    const Eigen::Vector3d on_target = from + t * (to - from);
    const Eigen::Vector3d p = camera_from_target * on_target;
    const auto pixel = camera.Project(p);
    if (!pixel) return false;
    const Eigen::Matrix<double, 1, 3> by_point =
        Eigen::RowVector2d(-tangent.y(), tangent.x()) * PixelByPoint(camera.lens(), p);
    *residual = Eigen::RowVector2d(-tangent.y(), tangent.x()) * (*pixel - at);
    *by_camera << -by_point * Cross(p), by_point;
    *by_target << -by_point * rotation * Cross(on_target), by_point * rotation;
    *by_outline = by_point * rotation * outward;
    return true;
  }

  void AddCrossings() {
    // Over the board's pose, the class's shift, the thickness and the outline (whose derivatives
    // are the side's and the kind's), added up for each of them apart.
    constexpr int kSums = 9;
    using Sums = Eigen::Matrix<double, kSums, kSums>;
    using Sum = Eigen::Matrix<double, kSums, 1>;
    std::array<std::array<Sums, 3>, 4> h;
    std::array<std::array<Sum, 3>, 4> g;
    for (int side = 0; side < 4; ++side) {
      for (int kind = 0; kind < 3; ++kind) {
        h[side][kind].setZero();
        g[side][kind].setZero();
      }
    }
    for (const Crossing& crossing : view_.cloud.crossings) {
      const auto side = static_cast<std::size_t>(crossing.side);
      if (!view_.sides[side] || !(crossing.sigma_m > 0)) continue;
      const CrossingResidual r = ResidualOf(problem_.target, problem_.priors, crossing,
                                            lidar_from_target_, state_.shared, side_shift_[side]);
      if (!(r.per_rad > 0)) continue;
      Sum j;
      j << r.by_target.transpose(), -r.per_rad, -r.per_thickness, -1;
      const double squared = r.beyond_m * r.beyond_m / (r.sigma_m * r.sigma_m);
      // What its neighbours tell, too, counts once: in weight, not in what is far off.
      const double share = r.sigma_m * r.sigma_m / (crossing.sigma_m * crossing.sigma_m);
      const double weight = RobustWeight(squared) / (crossing.sigma_m * crossing.sigma_m);
      cost_ += share * RobustCost(squared);
      const auto kind = static_cast<std::size_t>(crossing.kind) - 1;
      h[side][kind].noalias() += weight * j * j.transpose();
      g[side][kind].noalias() -= weight * r.beyond_m * j;
    }
    for (int side = 0; side < 4; ++side) {
      for (int kind = 0; kind < 3; ++kind) {
        const auto s = static_cast<std::size_t>(side);
        SpreadCrossings(side, kind, h[s][static_cast<std::size_t>(kind)],
                        g[s][static_cast<std::size_t>(kind)]);
      }
    }
  }

  void SpreadCrossings(int side, int kind, const Eigen::Matrix<double, 9, 9>& h,
                       const Eigen::Matrix<double, 9, 1>& g) {
    if (h(8, 8) == 0) return;
    // Places of the ten derivatives: the class's shift stands for the side's, too.
    const std::array<int, 10> place{0,
                                    1,
                                    2,
                                    3,
                                    4,
                                    5,
                                    Shared(kNoReturnShift + kind),
                                    Shared(kThickness),
                                    Shared(kOutlineTop + side),
                                    6 + side};
    const std::array<int, 10> sum{0, 1, 2, 3, 4, 5, 6, 7, 8, 6};
    for (std::size_t a = 0; a < 10; ++a) {
      for (std::size_t b = 0; b < 10; ++b) h_(place[a], place[b]) += h(sum[a], sum[b]);
      g_[place[a]] += g[sum[a]];
    }
  }

  // x = (n, n . (centre + offset - t)), n the board's normal: x' scatter x is the sum of squares.
  void AddPlane() {
    const double sigma = view_.cloud.scatter_sigma_m;
    if (!(sigma > 0)) return;
    const Eigen::Matrix3d rotation = lidar_from_target_.rotation.toRotationMatrix();
    const Eigen::Vector3d n = rotation.col(2);
    const Eigen::Vector3d along = view_.cloud.centre.normalized();
    const Eigen::Vector3d from_target =
        view_.cloud.centre + state_.shared[kRangeOffset] * along - lidar_from_target_.translation;
    Eigen::Vector4d x;
    x << n, n.dot(from_target);
    // Columns: rotation about the target's x and y, shift along its z, the range offset.
    Eigen::Matrix4d j = Eigen::Matrix4d::Zero();
    j.block<3, 1>(0, 0) = -rotation.col(1);
    j.block<3, 1>(0, 1) = rotation.col(0);
    j(3, 0) = -rotation.col(1).dot(from_target);
    j(3, 1) = rotation.col(0).dot(from_target);
    j(3, 2) = -1;
    j(3, 3) = n.dot(along);
    const Eigen::Matrix4d information = view_.cloud.scatter / (sigma * sigma);
    const Eigen::Matrix4d h = j.transpose() * information * j;
    const Eigen::Vector4d g = -j.transpose() * information * x;
    cost_ += x.dot(information * x);
    const std::array<int, 4> place{0, 1, 5, Shared(kRangeOffset)};
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < 4; ++b) {
        h_(place[static_cast<std::size_t>(a)], place[static_cast<std::size_t>(b)]) += h(a, b);
      }
      g_[place[static_cast<std::size_t>(a)]] += g[a];
    }
  }

  void AddSidePriors() {
    const double weight = 1 / (problem_.priors.side_sigma_rad * problem_.priors.side_sigma_rad);
    for (int side = 0; side < 4; ++side) {
      const double shift = side_shift_[static_cast<std::size_t>(side)];
      h_(6 + side, 6 + side) += weight;
      g_[6 + side] -= weight * shift;
      cost_ += weight * shift * shift;
    }
  }

  const BoardProblem& problem_;
  const BoardView& view_;
  const BoardState& state_;
  const Rigid3& lidar_from_target_;
  const std::array<double, 4>& side_shift_;
  int cameras_;
  Eigen::MatrixXd h_;
  Eigen::VectorXd g_;
  double cost_ = 0;
};

// A view's equations with its own unknowns eliminated, and how to get these back.
struct Reduced {
  ViewInformation shared;
  Eigen::Matrix<double, kLocal, Eigen::Dynamic> local_by_shared;
  Eigen::Matrix<double, kLocal, 1> local;
};

Reduced Reduce(const ViewEquations& equations, double damping) {
  const auto shared = equations.h().cols() - kLocal;
  Eigen::Matrix<double, kLocal, kLocal> local = equations.h().topLeftCorner<kLocal, kLocal>();
  local.diagonal() *= 1 + damping;
  const Eigen::LDLT<Eigen::Matrix<double, kLocal, kLocal>> ldlt(local);
  const Eigen::Matrix<double, kLocal, Eigen::Dynamic> coupling =
      equations.h().topRightCorner(kLocal, shared);
  Reduced out;
  out.local_by_shared = ldlt.solve(coupling);
  out.local = ldlt.solve(equations.g().head<kLocal>());
  out.shared.information =
      equations.h().bottomRightCorner(shared, shared) - coupling.transpose() * out.local_by_shared;
  out.shared.gradient = equations.g().tail(shared) - coupling.transpose() * out.local;
  return out;
}

// Adds the priors of what the views share; returns their cost.
double AddPriors(const BoardProblem& problem, const BoardState& state, Eigen::MatrixXd* h,
                 Eigen::VectorXd* g) {
  const auto first = static_cast<Eigen::Index>(6 * problem.cameras.size());
  const auto means = problem.priors.Means();
  double cost = 0;
  for (int k = 0; k < kSharedUnknowns; ++k) {
    const double sigma = problem.priors.Sigma(k);
    const auto i = static_cast<std::size_t>(k);
    const double off = state.shared[i] - means[i];
    (*h)(first + k, first + k) += 1 / (sigma * sigma);
    (*g)[first + k] -= off / (sigma * sigma);
    cost += off * off / (sigma * sigma);
  }
  return cost;
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
    Eigen::MatrixXd h = Eigen::MatrixXd::Zero(Size(), Size());
    Eigen::VectorXd g = Eigen::VectorXd::Zero(Size());
    cost_ += AddPriors(problem, state_, &h, &g);
    prior_ = {h, g};
  }

  double cost() const { return cost_; }
  const BoardState& state() const { return state_; }

  // The state after the step with this damping; `size` is the step's length in sigmas, squared.
  BoardState Take(double damping, double* size) const {
    std::vector<Reduced> reduced;
    Eigen::MatrixXd h = prior_.information;
    Eigen::VectorXd g = prior_.gradient;
    for (const ViewEquations& e : equations_) {
      reduced.push_back(Reduce(e, damping));
      h += reduced.back().shared.information;
      g += reduced.back().shared.gradient;
    }
    h.diagonal() *= 1 + damping;
    const Eigen::VectorXd x = h.ldlt().solve(g);
    *size = x.dot(h * x);
    BoardState next = state_;
    for (std::size_t c = 0; c < next.camera_from_lidar.size(); ++c) {
      next.camera_from_lidar[c] =
          Exp(x.segment<6>(static_cast<Eigen::Index>(6 * c))) * next.camera_from_lidar[c];
    }
    const auto first = static_cast<Eigen::Index>(6 * next.camera_from_lidar.size());
    for (int k = 0; k < kSharedUnknowns; ++k) {
      next.shared[static_cast<std::size_t>(k)] += x[first + k];
    }
    for (std::size_t v = 0; v < reduced.size(); ++v) {
      const Eigen::Matrix<double, kLocal, 1> local =
          reduced[v].local - reduced[v].local_by_shared * x;
      *size += local.dot(equations_[v].h().topLeftCorner<kLocal, kLocal>() * local);
      next.lidar_from_target[v] = next.lidar_from_target[v] * Exp(local.head<6>());
      for (int side = 0; side < 4; ++side) {
        next.side_shift[v][static_cast<std::size_t>(side)] += local[6 + side];
      }
    }
    return next;
  }

  void Conclude(BoardSolution* solution) const {
    Eigen::MatrixXd h = prior_.information;
    for (const ViewEquations& e : equations_) {
      solution->views.push_back(Reduce(e, 0).shared);
      const Eigen::Matrix<double, kLocal, kLocal> local =
          e.h().topLeftCorner<kLocal, kLocal>().inverse();
      solution->side_variance.push_back({local(6, 6), local(7, 7), local(8, 8), local(9, 9)});
      h += solution->views.back().information;
    }
    solution->covariance = h.ldlt().solve(Eigen::MatrixXd::Identity(Size(), Size()));
  }

 private:
  Eigen::Index Size() const {
    return static_cast<Eigen::Index>(6 * problem_.cameras.size()) + kSharedUnknowns;
  }

  const BoardProblem& problem_;
  BoardState state_;
  std::vector<ViewEquations> equations_;
  ViewInformation prior_;
  double cost_ = 0;
};

}  // namespace

std::array<double, kSharedUnknowns> BoardPriors::Means() const {
  std::array<double, kSharedUnknowns> means{};
  means[kThickness] = thickness_m;
  return means;
}

double BoardPriors::Sigma(int unknown) const {
  if (unknown <= kMergedShift) return class_sigma_rad;
  if (unknown == kThickness) return thickness_sigma_m;
  if (unknown == kRangeOffset) return range_offset_sigma_m;
  return outline_sigma_m;
}

CrossingResidual ResidualOf(const Target& target, const BoardPriors& priors,
                            const Crossing& crossing, const Rigid3& lidar_from_target,
                            const std::array<double, kSharedUnknowns>& shared, double side_shift) {
  CrossingResidual out;
  out.by_target.setZero();
  const Eigen::Matrix3d rotation = lidar_from_target.rotation.toRotationMatrix();
  const Eigen::Vector3d beam = rotation.transpose() * crossing.point.normalized();
  const Eigen::Vector3d origin = -(rotation.transpose() * lidar_from_target.translation);
  if (!(beam.z() > 0.02)) return out;  // the beam does not meet the board's front
  const double range = -origin.z() / beam.z();
  const Eigen::Vector2d at = (origin + range * beam).head<2>();
  const Eigen::Vector2d slope = beam.head<2>() / beam.z();
  const Eigen::Vector2d outward = OutwardOf(crossing.side);
  const double sideways = slope.dot(outward) / std::sqrt(1 + slope.squaredNorm());
  // A beam that meets the plane at a slant is drawn out on it; a rim that faces the LIDAR is seen
  // beside the front.
  out.per_rad = range / std::sqrt(1 - sideways * sideways);
  out.per_thickness = std::max(0.0, -slope.dot(outward));
  const auto kind = static_cast<std::size_t>(crossing.kind) - 1;
  out.beyond_m = outward.dot(at) - HalfExtent(target, crossing.side) -
                 shared[static_cast<std::size_t>(kOutlineTop + crossing.side)] -
                 out.per_rad * (shared[kNoReturnShift + kind] + side_shift) -
                 out.per_thickness * shared[kThickness];
  const double blur = priors.blur_rad * out.per_rad;
  out.sigma_m = std::sqrt(crossing.half_width_m * crossing.half_width_m / 3 + blur * blur);
  // The board moves by delta under the beam: a point at (x, y, 0) goes the other way in its axes,
  // and the beam meets the plane elsewhere by the slope.
  const double across = outward.dot(slope);
  out.by_target << across * at.y(), -across * at.x(), outward.x() * at.y() - outward.y() * at.x(),
      -outward.x(), -outward.y(), across;
  return out;
}

BoardState StartOf(const BoardProblem& problem, const std::vector<Rigid3>& camera_from_lidar) {
  BoardState state;
  state.camera_from_lidar = camera_from_lidar;
  state.shared = problem.priors.Means();
  for (const BoardView& view : problem.views) {
    state.lidar_from_target.push_back(view.cloud.pose->sensor_from_target);
    state.side_shift.push_back({});
  }
  return state;
}

BoardSolution SolveBoards(const BoardProblem& problem, const BoardState& start) {
  constexpr int kIterations = 100;
  constexpr double kSettled = 1e-4;  // a hundredth of a sigma
  BoardSolution solution;
  double damping = 0;
  auto here = std::make_unique<Step>(problem, start);
  for (; solution.iterations < kIterations && !solution.converged; ++solution.iterations) {
    double size = 0;
    auto there = std::make_unique<Step>(problem, here->Take(damping, &size));
    if (!(there->cost() <= here->cost() * (1 + 1e-12))) {
      damping = std::max(1e-4, 10 * damping);
      // Where not even a small step helps, this is the minimum as far as rounding tells.
      solution.converged = damping > 1e4 || size < kSettled;
      continue;
    }
    damping = damping < 1e-3 ? 0 : 0.1 * damping;
    solution.converged = size < kSettled;
    here = std::move(there);
  }
  solution.state = here->state();
  here->Conclude(&solution);
  return solution;
}

ViewInformation InformationOf(const BoardProblem& problem, const BoardState& state,
                              std::size_t view) {
  return Reduce(ViewEquations(problem, state, view), 0).shared;
}

double MisfitOf(const BoardProblem& problem, BoardState state, std::size_t view, int camera) {
  constexpr int kIterations = 20;
  for (int i = 0; i < kIterations; ++i) {
    const ViewEquations equations(problem, state, view);
    const Eigen::Matrix<double, kLocal, 1> step =
        equations.h().topLeftCorner<kLocal, kLocal>().ldlt().solve(equations.g().head<kLocal>());
    state.lidar_from_target[view] = state.lidar_from_target[view] * Exp(Vector6d(step.head<6>()));
    for (int side = 0; side < 4; ++side) {
      state.side_shift[view][static_cast<std::size_t>(side)] += step[6 + side];
    }
    if (step.head<6>().norm() < 1e-8) break;
  }
  const ViewInformation reduced = Reduce(ViewEquations(problem, state, view), 0).shared;
  const Eigen::Index at = 6 * camera;
  const Matrix6d information = reduced.information.block<6, 6>(at, at);
  const Vector6d gradient = reduced.gradient.segment<6>(at);
  return gradient.dot(information.ldlt().solve(gradient));
}

}  // namespace rgbdt
