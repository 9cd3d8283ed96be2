#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/solve/board_problem.h"

namespace rgbdt {

inline constexpr int kOwnUnknowns = 10;  ///< of a view: its board's pose, its four sides' shifts

/// What a further LIDAR's cloud says of one view: the equations that the view would have were it
/// the reference's (ViewEquations), its four sides' shifts eliminated, in the places of the
/// problem's view. With b = lidar_from_target and c = reference_from_target, its board's delta is
/// the view's own less Adjoint(c^-1) times the delta of reference_from_lidar, as
/// b = reference_from_lidar^-1 * c.
class FurtherCloud {
 public:
  /// `places`: of `problem`, of which this is LIDAR `lidar` and view `view`.
  FurtherCloud(const BoardProblem& problem, const BoardState& state, const SharedPlaces& places,
               std::size_t lidar, std::size_t view);

  double cost() const { return cost_; }  ///< robust, whitened, squared
  /// Onto a view's normal equations: its own unknowns, then the shared ones.
  void AddTo(Eigen::MatrixXd* h, Eigen::VectorXd* g) const;
  /// By how much the sides' shifts change where the view's unknowns do by x (own, then shared)
  /// [rad].
  Eigen::Vector4d SideStep(const Eigen::VectorXd& x) const;

 private:
  std::vector<Eigen::Index> place_;  // of the unknowns that `h_` is about, in the view's equations
  Eigen::MatrixXd h_;
  Eigen::VectorXd g_;
  double cost_ = 0;
  Eigen::Vector4d side_step_;
  Eigen::Matrix<double, 4, Eigen::Dynamic> side_by_;  // side_step_ - side_by_ * x at place_
};

}  // namespace rgbdt
