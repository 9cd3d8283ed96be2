#include "calib/odometry/internal/pose_graph.h"

#include <ceres/ceres.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "calib/model/errors.h"
#include "calib/model/linear_algebra.h"

namespace rgbdt::odometry {
namespace {

using Delta = std::array<double, 6>;

// Chi-square of a loop's six numbers after the solve, beyond which it contradicts the rest: chance
// would do it once in 10^4 times (27.9) even where its covariance is four times too small.
constexpr double kMostContradiction = 4 * 27.9;
// Of the robust weights: what chance does not exceed.
constexpr double kRobustScale = 5.3;  // sqrt(27.9)

Rigid3 Moved(const Rigid3& pose, const double* delta) {
  return pose * Exp(Vector6d(Eigen::Map<const Vector6d>(delta)));
}

Vector6d Off(const PoseEdge& edge, const Rigid3& from, const Rigid3& to) {
  return Log(edge.from_from_to.Inverse() * (from.Inverse() * to));
}

// r = root Log(measured^-1 from^-1 to), each pose * Exp(its delta); root^T root is the information.
// Derivatives by differences: there are 12 of them, and hundreds of edges.
struct EdgeCost {
  PoseEdge edge;
  Rigid3 from, to;
  Matrix6d root;

  bool operator()(const double* delta_from, const double* delta_to, double* residuals) const {
    const Vector6d off = root * Off(edge, Moved(from, delta_from), Moved(to, delta_to));
    std::copy(off.data(), off.data() + 6, residuals);
    return true;
  }
};

Matrix6d RootOfInformation(const Matrix6d& covariance) {
  const Matrix6d information = InverseOfSymmetric(covariance);
  return Eigen::LLT<Matrix6d>(information).matrixU();
}

using Poses = std::vector<Rigid3>;

void AddEdge(const PoseEdge& edge, const Poses& start, ceres::LossFunction* loss,
             std::vector<Delta>* deltas, ceres::Problem* problem) {
  auto* cost = new ceres::NumericDiffCostFunction<EdgeCost, ceres::CENTRAL, 6, 6, 6>(
      new EdgeCost{edge, start[edge.from], start[edge.to], RootOfInformation(edge.covariance)});
  problem->AddResidualBlock(cost, loss, (*deltas)[edge.from].data(), (*deltas)[edge.to].data());
}

// Poses after one solve of all these edges; nothing where it fails.
std::optional<Poses> Solve(const Poses& start, const std::vector<PoseEdge>& chain,
                           const std::vector<PoseEdge>& loops, bool robust) {
  std::vector<Delta> deltas(start.size(), Delta{});
  ceres::Problem problem;
  for (Delta& delta : deltas) problem.AddParameterBlock(delta.data(), 6);
  problem.SetParameterBlockConstant(deltas.front().data());
  for (const PoseEdge& edge : chain) AddEdge(edge, start, nullptr, &deltas, &problem);
  for (const PoseEdge& edge : loops) {
    auto* loss = robust ? new ceres::CauchyLoss(kRobustScale) : nullptr;
    AddEdge(edge, start, loss, &deltas, &problem);
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.num_threads = 1;
  options.max_num_iterations = 50;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (!summary.IsSolutionUsable()) return std::nullopt;
  Poses poses;
  for (std::size_t i = 0; i < start.size(); ++i) poses.push_back(Moved(start[i], deltas[i].data()));
  return poses;
}

double Contradiction(const PoseEdge& loop, const Poses& poses) {
  const Vector6d off = Off(loop, poses[loop.from], poses[loop.to]);
  return off.dot(SolveSymmetric(loop.covariance, off));
}

std::vector<PoseEdge> Picked(const std::vector<PoseEdge>& loops,
                             const std::vector<std::size_t>& numbers) {
  std::vector<PoseEdge> picked;
  picked.reserve(numbers.size());
  for (const std::size_t i : numbers) picked.push_back(loops[i]);
  return picked;
}

void CheckEdges(const std::vector<PoseEdge>& edges, std::size_t poses) {
  for (const PoseEdge& edge : edges) {
    if (std::max(edge.from, edge.to) < poses) continue;
    throw InputError("pose graph: an edge goes from pose " + std::to_string(edge.from) + " to " +
                     std::to_string(edge.to) + "; there are " + std::to_string(poses));
  }
}

}  // namespace

PoseEdge Chained(const PoseEdge& first, const PoseEdge& second) {
  const Matrix6d onward = Adjoint(second.from_from_to.Inverse());
  return {first.from, second.to, first.from_from_to * second.from_from_to,
          onward * first.covariance * onward.transpose() + second.covariance};
}

// (T Exp(d))^-1 = T^-1 Exp(-Ad(T) d)
PoseEdge Inverted(const PoseEdge& edge) {
  const Matrix6d back = Adjoint(edge.from_from_to);
  return {edge.to, edge.from, edge.from_from_to.Inverse(),
          back * edge.covariance * back.transpose()};
}

double ChiSquare(const PoseEdge& a, const PoseEdge& b) {
  const Vector6d off = Log(a.from_from_to.Inverse() * b.from_from_to);
  return off.dot(SolveSymmetric(Matrix6d(a.covariance + b.covariance), off));
}

std::optional<SolvedGraph> SolveGraph(const std::vector<Rigid3>& start,
                                      const std::vector<PoseEdge>& chain,
                                      const std::vector<PoseEdge>& loops) {
  CheckEdges(chain, start.size());
  CheckEdges(loops, start.size());
  SolvedGraph graph;
  graph.poses = start;
  if (loops.empty()) return graph;
  const auto robust = Solve(start, chain, loops, true);
  if (!robust) return std::nullopt;
  for (std::size_t i = 0; i < loops.size(); ++i) {
    if (Contradiction(loops[i], *robust) <= kMostContradiction) graph.kept.push_back(i);
  }
  while (!graph.kept.empty()) {
    const auto poses = Solve(start, chain, Picked(loops, graph.kept), false);
    if (!poses) return std::nullopt;
    std::size_t worst = 0;
    double most = 0;
    for (std::size_t k = 0; k < graph.kept.size(); ++k) {
      const double off = Contradiction(loops[graph.kept[k]], *poses);
      if (off <= most) continue;
      most = off;
      worst = k;
    }
    if (most <= kMostContradiction) {
      graph.poses = *poses;
      return graph;
    }
    graph.kept.erase(graph.kept.begin() + static_cast<std::ptrdiff_t>(worst));
  }
  return graph;
}

}  // namespace rgbdt::odometry
