#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "calib/camera/camera.h"
#include "calib/model/observation.h"
#include "calib/model/rig.h"

namespace rgbdt {

/// The unknowns that all views share, in this order: 6 for each camera (delta about its pose, see
/// rigid3.h), then these.
enum SharedUnknown {
  kNoReturnShift,
  kFarShift,
  kMergedShift,
  kThickness,
  kOutlineTop,
  kOutlineRight,
  kOutlineBottom,
  kOutlineLeft,
  kRangeOffset,
  kSharedUnknowns
};

/// What is known beforehand of the solve's unknowns besides the poses. All but the thickness about
/// zero. What a beam's width does to an edge is an angle, outwards positive.
struct BoardPriors {
  double class_sigma_rad = 1.5e-3;  ///< shift of each class of crossing (CrossingKind)
  double side_sigma_rad = 0.3e-3;   ///< further shift of each side in each view
  double blur_rad = 0.4e-3;         ///< how exactly one beam tells inside from outside
  double thickness_m = 0.010, thickness_sigma_m = 0.010;  ///< of the board: its rim may be seen
  double outline_sigma_m = 0.001;      ///< each side's place against the pattern, as cut
  double range_offset_sigma_m = 1e-9;  ///< true range minus measured; next to nothing: known as 0

  std::array<double, kSharedUnknowns> Means() const;
  double Sigma(int unknown) const;
};

/// A detector's errors within one image are partly alike, more than their residuals show: poses
/// from rendered images are off by about half as much again as the corners' scatter has it
/// (scripts/study detection, corners). Sigmas of corners are enlarged by this.
inline constexpr double kCornersAlike = 1.4;

/// One camera's image of a board.
struct BoardSight {
  int camera = 0;  ///< index into BoardProblem::cameras
  const ImageEdges* image = nullptr;
  bool turned = false;  ///< its corners and sides are told from the other end of the board
};

/// One placing of the board: what the cloud and any number of cameras see of it.
struct BoardView {
  std::string name;
  CloudEdges cloud;  ///< with pose; its sides are the target's, `turned` undone
  std::array<bool, 4> sides{true, true, true, true};  ///< whose crossings have a say
  std::vector<BoardSight> sights;
};

/// All cameras' images and all clouds of one board.
struct BoardProblem {
  Target target;
  std::vector<Camera> cameras;
  std::vector<BoardView> views;
  BoardPriors priors;
};

/// Values of all unknowns.
struct BoardState {
  std::vector<Rigid3> camera_from_lidar;
  std::array<double, kSharedUnknowns> shared{};   ///< [rad] shifts, [m] the others
  std::vector<Rigid3> lidar_from_target;          ///< by view
  std::vector<std::array<double, 4>> side_shift;  ///< by view and side [rad]
};

/// What one view tells of the shared unknowns, its own ones eliminated: the cost is
/// x' information x / 2 - x' gradient + ..., x the shared unknowns' change.
struct ViewInformation {
  Eigen::MatrixXd information;
  Eigen::VectorXd gradient;
};

struct BoardSolution {
  BoardState state;
  Eigen::MatrixXd covariance;                        ///< of the shared unknowns, cameras first
  std::vector<ViewInformation> views;                ///< at the solution
  std::vector<std::array<double, 4>> side_variance;  ///< by view and side, of its shift [rad^2]
  bool converged = false;
  int iterations = 0;
};

/// Least squares over all cameras, boards and nuisances together, robust. Residuals, each whitened:
///
///  - corners: project(camera_from_lidar * lidar_from_target * corner) - seen, through the whole
///    lens, weighed down beyond 3 sigma, so that a wrong corner has no say;
///  - outline sides seen in an image: the projected side's distance from the fitted curve at both
///    of its ends, with that curve's covariance;
///  - crossings: where the beam meets the board's plane, its distance beyond the side, less what
///    the beam's width (class and side), the board's rim and the board's cut do;
///  - points on the board: their distances from its plane, all of a view in one quadratic form
///    (CloudEdges::scatter);
///  - the priors.
///
/// A crossing's distance to the fitted outline in the image is the difference of the second and the
/// third: both refer to the same side of the same board, whose pose all sensors share. Gauss-Newton
/// with exact derivatives, each view's ten unknowns eliminated (Schur complement). `start` is near:
/// some degrees and centimetres.
BoardSolution SolveBoards(const BoardProblem& problem, const BoardState& start);

/// Each view's board where its cloud puts it, nothing else known.
BoardState StartOf(const BoardProblem& problem, const std::vector<Rigid3>& camera_from_lidar);

/// What a view would tell of the shared unknowns at this state; its residuals do not matter.
ViewInformation InformationOf(const BoardProblem& problem, const BoardState& state,
                              std::size_t view);

/// How badly a pose of a camera fits a view that had no say in it: the chi-square of the step that
/// the view by itself would make it, the shared unknowns kept, the view's own ones at their best.
/// Six on average where all is as stated.
double MisfitOf(const BoardProblem& problem, BoardState state, std::size_t view, int camera);

/// A crossing against its side. All on the board, metres and radians.
struct CrossingResidual {
  double beyond_m = 0;                    ///< outwards of the side, shifts taken off
  double sigma_m = 0;                     ///< of this crossing alone
  Eigen::Matrix<double, 1, 6> by_target;  ///< d beyond / d delta, lidar_from_target * Exp(delta)
  double per_rad = 0;        ///< metres that a side seems farther out for each radian of shift
  double per_thickness = 0;  ///< the same for each metre of thickness
};
CrossingResidual ResidualOf(const Target& target, const BoardPriors& priors,
                            const Crossing& crossing, const Rigid3& lidar_from_target,
                            const std::array<double, kSharedUnknowns>& shared, double side_shift);

}  // namespace rgbdt
