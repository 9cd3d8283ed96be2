#include "calib/solve/internal/further_cloud.h"

#include <numeric>

#include "calib/model/linear_algebra.h"
#include "calib/solve/internal/view_equations.h"

namespace rgbdt {
namespace {

using Index = Eigen::Index;

constexpr int kPose = 6, kSides = 4;

// What the LIDAR's own equations are about, as they have it: shared nuisances and range terms.
BoardState OwnState(const BoardState& state, std::size_t lidar) {
  BoardState own;
  own.shared = state.shared;
  for (int k = 0; k < kSharedUnknowns; ++k) {
    const auto i = static_cast<std::size_t>(k);
    if (IsOfLidar(k)) own.shared[i] = state.lidars[lidar].shared[i];
  }
  own.range_terms = state.lidars[lidar].range_terms;
  return own;
}

}  // namespace

FurtherCloud::FurtherCloud(const BoardProblem& problem, const BoardState& state,
                           const SharedPlaces& places, std::size_t lidar, std::size_t view) {
  const BoardProblem& of_lidar = problem.lidars[lidar];
  const LidarState& lidar_state = state.lidars[lidar];
  const BoardState own = OwnState(state, lidar);
  const Rigid3& reference_from_target = state.lidar_from_target[view];
  const Rigid3 lidar_from_target =
      lidar_state.reference_from_lidar.Inverse() * reference_from_target;
  const ViewEquations equations(of_lidar, own, of_lidar.views[view], lidar_from_target,
                                lidar_state.side_shift[view]);
  cost_ = equations.cost();
  // The unknowns that stay: the board's pose, then all that is shared.
  const Index shared = SharedPlaces(of_lidar).Count();
  std::vector<Index> kept(static_cast<std::size_t>(kPose + shared));
  std::iota(kept.begin(), kept.begin() + kPose, Index{0});
  std::iota(kept.begin() + kPose, kept.end(), Index{kOwnUnknowns});
  const Eigen::Matrix4d of_sides = equations.h().block<kSides, kSides>(kPose, kPose);
  const Eigen::Matrix<double, kSides, Eigen::Dynamic> between =
      equations.h().middleRows<kSides>(kPose)(Eigen::all, kept);
  const Eigen::Matrix<double, kSides, Eigen::Dynamic> by_kept = SolveSymmetric(of_sides, between);
  side_step_ = SolveSymmetric(of_sides, Eigen::Vector4d(equations.g().segment<kSides>(kPose)));
  // And as the problem has them: the board's pose, the LIDAR's, all that is shared.
  Eigen::MatrixXd by_place = Eigen::MatrixXd::Zero(kPose + shared, 2 * kPose + shared);
  by_place.topLeftCorner<kPose, kPose>().setIdentity();
  by_place.block<kPose, kPose>(0, kPose) = -Adjoint(reference_from_target.Inverse());
  by_place.bottomRightCorner(shared, shared).setIdentity();
  const Eigen::MatrixXd h = equations.h()(kept, kept) - between.transpose() * by_kept;
  const Eigen::VectorXd g = equations.g()(kept) - between.transpose() * side_step_;
  h_ = by_place.transpose() * h * by_place;
  g_ = by_place.transpose() * g;
  side_by_ = by_kept * by_place;
  place_.resize(static_cast<std::size_t>(2 * kPose));
  std::iota(place_.begin(), place_.begin() + kPose, Index{0});
  std::iota(place_.begin() + kPose, place_.end(), kOwnUnknowns + places.LidarPose(lidar));
  for (int k = 0; k < kSharedUnknowns; ++k) {
    place_.push_back(kOwnUnknowns + places.Of(lidar, k));
  }
  for (std::size_t term = 0; term < of_lidar.ranges.Count(); ++term) {
    place_.push_back(kOwnUnknowns + places.RangeTerm(lidar, term));
  }
}

void FurtherCloud::AddTo(Eigen::MatrixXd* h, Eigen::VectorXd* g) const {
  (*h)(place_, place_) += h_;
  (*g)(place_) += g_;
}

Eigen::Vector4d FurtherCloud::SideStep(const Eigen::VectorXd& x) const {
  return side_step_ - side_by_ * Eigen::VectorXd(x(place_));
}

}  // namespace rgbdt
