#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "calib/camera/camera.h"
#include "calib/model/rig.h"
#include "calib/model/view_detection.h"
#include "calib/solve/board_model.h"

namespace rgbdt {

/// One camera's image of a board.
struct BoardImage {
  int camera = 0;  ///< index into BoardProblem::cameras
  const ImageEdges* edges = nullptr;
  bool turned = false;  ///< its corners and sides are told from the other end of the board
};

/// One placing of the board: what the cloud and any number of cameras see of it.
struct BoardView {
  std::string name;
  CloudEdges cloud;  ///< with pose; its sides are the target's, `turned` undone
  std::array<bool, 4> sides{true, true, true, true};  ///< whose crossings have a say
  std::vector<BoardImage> images;
};

/// All cameras' images and all clouds of one board.
struct BoardProblem {
  Target target;
  std::vector<Camera> cameras;              ///< with their given lenses
  std::vector<LensCovariance> lens_priors;  ///< by camera, about the given lens; zero: exact
  /// By camera, the first one with the same lens: one that moved on its mount between two sessions
  /// is two cameras with one lens. Empty: each has its own.
  std::vector<std::size_t> lens_of;
  std::vector<BoardView> views;
  BoardPriors priors;
  RangeTerms ranges;
  /// The LIDAR is taken for exact: groups of points are not told apart.
  bool ranges_exact = false;
  /// LIDARs beside the one in whose frame all is solved, each as a problem without cameras: its
  /// clouds, in step with `views` (without crossings and points where it saw no board), what is
  /// known of it, and its range terms. The board's unknowns (not IsOfLidar) are this problem's.
  std::vector<BoardProblem> lidars{};

  /// The first camera with this one's lens.
  std::size_t LensOf(std::size_t camera) const {
    return lens_of.empty() ? camera : lens_of[camera];
  }
  bool HasOwnLens(std::size_t camera) const { return LensOf(camera) == camera; }

  /// Whether a camera sees the target's pattern (a thermal one may not); without cameras: whether
  /// it has one.
  bool PatternIsSeen() const;

  /// The prior's, of a term of `ranges` [m].
  double SigmaOfTerm(std::size_t term) const {
    return term < ranges.rings.size() ? priors.ring_sigma_m : priors.octave_sigma_m;
  }
};

/// Values of a further LIDAR's unknowns.
struct LidarState {
  Rigid3 reference_from_lidar;
  std::array<double, kSharedUnknowns> shared{};   ///< as BoardState::shared, where IsOfLidar
  std::vector<double> range_terms;                ///< by term of its problem's `ranges` [m]
  std::vector<std::array<double, 4>> side_shift;  ///< by view and side [rad]
};

/// Values of all unknowns.
struct BoardState {
  std::vector<Rigid3> camera_from_lidar;
  std::vector<Lens> lenses;                       ///< by camera
  std::array<double, kSharedUnknowns> shared{};   ///< [rad] shifts, 1 print, [m] the others
  std::vector<Rigid3> lidar_from_target;          ///< by view
  std::vector<std::array<double, 4>> side_shift;  ///< by view and side [rad]
  std::vector<double> range_terms;                ///< by term of BoardProblem::ranges [m]
  std::vector<LidarState> lidars{};               ///< by BoardProblem::lidars
};

/// Places of the unknowns that all views share: each camera's pose (delta, rigid3.h),
/// SharedUnknown, each lens (NumbersOf), range offsets (RangeTerms); then of each further LIDAR its
/// pose (reference_from_lidar = Exp(delta) * estimate), its own SharedUnknowns, its range offsets.
class SharedPlaces {
 public:
  explicit SharedPlaces(const BoardProblem& problem);

  static Eigen::Index Pose(std::size_t camera) { return static_cast<Eigen::Index>(6 * camera); }
  Eigen::Index Of(int shared_unknown) const { return shared_ + shared_unknown; }
  /// Of a camera's lens, which may be another one's, too.
  Eigen::Index Lens(std::size_t camera) const { return lenses_[camera]; }
  Eigen::Index RangeTerm(std::size_t term) const {
    return range_terms_ + static_cast<Eigen::Index>(term);
  }
  Eigen::Index LidarPose(std::size_t lidar) const { return lidars_[lidar]; }
  /// As further LIDAR `lidar` has it; the board's is everybody's.
  Eigen::Index Of(std::size_t lidar, int shared_unknown) const;
  Eigen::Index RangeTerm(std::size_t lidar, std::size_t term) const;
  Eigen::Index Count() const { return count_; }
  /// Of a camera's pose and its lens.
  std::array<Eigen::Index, kPoseAndLens> PoseAndLens(std::size_t camera) const;

 private:
  Eigen::Index shared_, range_terms_ = 0, count_ = 0;
  std::vector<Eigen::Index> lenses_;  // by camera
  std::vector<Eigen::Index> lidars_;  // where each one's unknowns begin
};

/// What one view says of the shared unknowns, its own ones eliminated: the cost is
/// x' information x / 2 - x' gradient + ..., x the shared unknowns' change.
struct ViewInformation {
  Eigen::MatrixXd information;
  Eigen::VectorXd gradient;
};

/// How a view's own unknowns (its board's pose, right delta; its sides' shifts) follow the shared
/// ones: where those change by x, they change by `step` - `by_shared` x.
struct OwnUnknowns {
  Eigen::VectorXd step;
  Eigen::MatrixXd by_shared;
};

struct BoardSolution {
  BoardState state;
  Eigen::MatrixXd covariance;                        ///< of the shared unknowns (SharedPlaces)
  std::vector<ViewInformation> views;                ///< at the solution
  std::vector<OwnUnknowns> own;                      ///< by view, at the solution
  std::vector<std::array<double, 4>> side_variance;  ///< by view and side, of its shift [rad^2]
  bool converged = false;
  int iterations = 0;

  PoseAndLensCovariance PoseAndLens(const SharedPlaces& all, std::size_t camera) const;
};

/// Whether a further LIDAR's cloud has a say in a view.
bool HasCloud(const BoardProblem& problem, std::size_t lidar, std::size_t view);

/// Least squares over all cameras, boards and nuisances together, robust. Residuals, each whitened:
///
///  - corners: project(camera_from_lidar * lidar_from_target * corner) - seen, through the whole
///    lens, weighed down beyond 3 sigma, so that a wrong corner has no say;
///  - outline sides seen in an image: the projected side's distance from the fitted curve at both
///    of its ends, with that curve's covariance;
///  - crossings: where the beam meets the board's plane, its distance beyond the side (in metres at
///    the range at which it was seen, CrossingResidual), less what the beam's width (class and
///    side), the board's rim and the board's cut do;
///  - points on the board: their distances from its plane, a quadratic form for each group of them
///    (CloudEdges::groups), or one for all of a view (CloudEdges::scatter); what the rings of one
///    view are off by besides is noise that the points of a ring share;
///  - the priors, of each lens, too: its numbers are unknowns like the others;
///  - of each further LIDAR the same crossings, points and priors, of the same boards by way of its
///    own pose.
///
/// A crossing's distance to the fitted outline in the image is the difference of the second and the
/// third: both refer to the same side of the same board, whose pose all sensors share. Gauss-Newton
/// with exact derivatives (ceres_test.cc), each view's ten unknowns eliminated (Schur complement).
/// `start` is near: some degrees and centimetres. `settled` is how small the last step must be, in
/// sigmas of all unknowns together, squared.
BoardSolution SolveBoards(const BoardProblem& problem, const BoardState& start,
                          double settled = 1e-4);

/// A problem and where its solve starts.
struct BoardStart {
  BoardProblem problem;
  BoardState start;
};

/// The problem with some of the views only, to be solved from `state`.
BoardStart Part(const BoardProblem& problem, const std::vector<std::size_t>& views,
                const BoardState& state);

/// The solution from some of the views, near the one from all of them. The normal equations of
/// these views at the solution of all are at hand: their step is taken, and one more from where it
/// leads. Where steps do not shrink quickly, as wrong corners or sides gain or lose their say,
/// SolveBoards goes on; else `iterations` is 0. `views` and `own` are those of the views taken.
BoardSolution SolveSome(const BoardProblem& problem, const BoardSolution& all,
                        const std::vector<std::size_t>& views);

/// Each view's board where its cloud puts it, the given lenses, nothing else known.
BoardState StartOf(const BoardProblem& problem, const std::vector<Rigid3>& camera_from_lidar,
                   const std::vector<Rigid3>& reference_from_lidar = {});

/// What the priors tell of the shared unknowns at a state.
ViewInformation PriorInformation(const BoardProblem& problem, const BoardState& state);

/// What a view would tell of the shared unknowns at this state; its residuals do not matter.
ViewInformation InformationOf(const BoardProblem& problem, const BoardState& state,
                              std::size_t view);

/// An end of a side of the board in one image: how far beside it the side lies where the state puts
/// it, and what its own fit says of that (1 sigma); in metres on the board.
struct ImageSideEnd {
  double beside_m = 0, sigma_m = 0;
};
std::vector<ImageSideEnd> ImageSideEnds(const BoardProblem& problem, const BoardState& state,
                                        std::size_t view);

/// By how much a ring's points in one view lie nearer than the board's plane, as the state has it:
/// the range offset that they ask for besides, and its variance by their own noise.
struct RingOff {
  int ring = 0;
  double offset_m = 0, variance_m2 = 0;
};
struct RingsInView {
  std::vector<RingOff> rings;
  /// How many of the offsets' freedoms the view's own unknowns take: 3 where the points alone tell
  /// the board's plane, fewer as the images tell it, too.
  double fitted = 0;
};
RingsInView RingsOff(const BoardProblem& problem, const BoardState& state, std::size_t view);

/// How badly a pose of a camera fits a view that had no say in it.
struct Misfit {
  /// Chi-square of the step that the view by itself would make the pose, the lens and the shared
  /// unknowns kept, the view's own ones at their best. Six on average of the truth.
  double chi2 = 0;
  Matrix6d information;  ///< of the view, of the pose
  Eigen::Matrix<double, 6, kPoseAndLens> gradient_by_calibration;

  /// The chi2 to be expected where pose and lens have this covariance.
  double Expected(const PoseAndLensCovariance& covariance) const;
};
Misfit MisfitOf(const BoardProblem& problem, BoardState state, std::size_t view, int camera);

}  // namespace rgbdt
