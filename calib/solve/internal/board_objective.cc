#include "calib/solve/internal/board_objective.h"

#include "calib/solve/first_guess.h"

namespace rgbdt {
namespace {

constexpr double kMostSquared = 1e8;   // of a whitened residual
constexpr double kLeastWeight = 1e-9;  // of a crossing that the cloud's own pose cannot explain

double BoundedCost(double squared) {
  return RobustCost(squared < kMostSquared ? squared : kMostSquared);  // NaN, too
}

// A view and what is known of its sides; `state` index and all.
struct ViewTerms {
  const BoardProblem& problem;
  const BoardView& view;
  const BoardState& shared_state;
  const std::array<double, 4>& side_shift;

  // Noise that it shares with its neighbours counts once.
  double Weight(const Crossing& crossing) const {
    const auto sigma =
        SigmaByCloud(problem.target, problem.priors, crossing, view.cloud, shared_state.shared);
    return sigma ? *sigma * *sigma / (crossing.sigma_m * crossing.sigma_m) : kLeastWeight;
  }

  double Crossings(const Rigid3& lidar_from_target) const {
    double cost = 0;
    for (const Crossing& crossing : view.cloud.crossings) {
      const auto side = static_cast<std::size_t>(crossing.side);
      if (!view.sides[side] || !(crossing.sigma_m > 0)) continue;
      const CrossingResidual r =
          ResidualOf(problem.target, problem.priors, crossing, lidar_from_target,
                     shared_state.shared, side_shift[side]);
      const double squared =
          r.per_rad > 0 ? r.beyond_m * r.beyond_m / (r.sigma_m * r.sigma_m) : kMostSquared;
      cost += Weight(crossing) * BoundedCost(squared);
    }
    return cost;
  }

  double Plane(const Rigid3& lidar_from_target) const {
    const CloudEdges& cloud = view.cloud;
    const double points = cloud.scatter(3, 3);
    if (!(cloud.scatter_sigma_m > 0) || !(points > 0) || !(cloud.raw_scatter(3, 3) > 0)) return 0;
    const Eigen::Vector4d x =
        ResidualOf(cloud, lidar_from_target, shared_state.shared[kRangeOffset],
                   shared_state.shared[kBeamsMeet])
            .x;
    const double sigma2 = cloud.scatter_sigma_m * cloud.scatter_sigma_m;
    return points * BoundedCost(x.dot(cloud.scatter * x) / (points * sigma2));
  }
};

}  // namespace

double BoardObjective(const BoardProblem& problem, const BoardState& shared_state,
                      const std::vector<Rigid3>& camera_from_lidar) {
  double cost = 0;
  for (std::size_t v = 0; v < problem.views.size(); ++v) {
    const BoardView& view = problem.views[v];
    const ViewTerms terms{problem, view, shared_state, shared_state.side_shift[v]};
    for (const BoardImage& image : view.images) {
      Rigid3 lidar_from_target =
          camera_from_lidar[static_cast<std::size_t>(image.camera)].Inverse() *
          image.edges->pose->sensor_from_target;
      if (HalfTurned(lidar_from_target, *view.cloud.pose)) {
        lidar_from_target = lidar_from_target * kHalfTurn;
      }
      cost += terms.Crossings(lidar_from_target) + terms.Plane(lidar_from_target);
    }
  }
  return cost;
}

}  // namespace rgbdt
