#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "calib/solve/board_problem.h"
#include "calib/solve/internal/further_cloud.h"

namespace rgbdt {

/// One view's normal equations about a state: h x = g, x the step. Its own unknowns come first
/// (board's pose: right delta, lidar_from_target * Exp(delta); then sides' shifts [rad]), then the
/// shared ones (SharedPlaces). Problem and state must outlive it.
class ViewEquations {
 public:
  using OwnMatrix = Eigen::Matrix<double, kOwnUnknowns, kOwnUnknowns>;

  ViewEquations(const BoardProblem& problem, const BoardState& state, std::size_t view);
  /// Without further LIDARs, of a view that need not be among the problem's; must outlive it, too.
  ViewEquations(const BoardProblem& problem, const BoardState& state, const BoardView& view,
                const Rigid3& lidar_from_target, const std::array<double, 4>& side_shift);

  double cost() const { return cost_; }  ///< robust, whitened, squared
  const Eigen::MatrixXd& h() const { return h_; }
  const Eigen::VectorXd& g() const { return g_; }
  const std::vector<ImageSideEnd>& image_side_ends() const { return image_side_ends_; }
  const std::vector<RingOff>& rings_off() const { return rings_off_; }
  /// What the points on the board alone add to `h` of the own unknowns.
  const OwnMatrix& of_points() const { return of_points_; }
  /// What each further LIDAR adds, which is in `h`, `g` and `cost`.
  const std::vector<FurtherCloud>& further() const { return further_; }

 private:
  using Row6 = Eigen::Matrix<double, 1, 6>;
  // What an image's corners depend on: the board's pose, the camera's, its lens, the print, the
  // board's shape.
  static constexpr int kImageUnknowns = 6 + kPoseAndLens + 2 + 3;
  using ImageMatrix = Eigen::Matrix<double, kImageUnknowns, kImageUnknowns>;
  using ImageVector = Eigen::Matrix<double, kImageUnknowns, 1>;

  Eigen::Index Size() const { return kOwnUnknowns + places_.Count(); }
  Eigen::Index Shared(int unknown) const { return kOwnUnknowns + places_.Of(unknown); }
  // Where the given lens sees a point, the pixel is by the lens of this state.
  std::optional<Eigen::Vector2d> Project(int camera, const Eigen::Vector3d& point) const;
  const Lens& LensOf(int camera) const { return state_.lenses[static_cast<std::size_t>(camera)]; }

  void AddCorners(const BoardImage& image);
  void Spread(int camera, const ImageMatrix& h, const ImageVector& g);
  void AddImageSides(const BoardImage& image);
  void AddImageSide(const BoardImage& image, const ImageSide& side, int on_board);
  struct CurveEnd {  // how far beside it the projected side lies [px], and derivatives
    double beside = 0;
    Row6 by_camera, by_target;
    Eigen::Matrix<double, 1, kLensNumbers> by_lens;
    double by_outline = 0;
    Eigen::RowVector3d by_bow;
  };
  std::optional<CurveEnd> AtCurveEnd(const BoardImage& image, int side, const Eigen::Vector2d& at,
                                     const Eigen::Vector2d& along) const;
  double OwnSigma(const Crossing& crossing, const CrossingResidual& here) const;
  void AddCrossings();
  // Over the board's pose, the class's shift, the thickness, the outline, where beams meet, the
  // fringe and the board's shape.
  static constexpr int kCrossingUnknowns = 14;
  using CrossingMatrix = Eigen::Matrix<double, kCrossingUnknowns, kCrossingUnknowns>;
  using CrossingVector = Eigen::Matrix<double, kCrossingUnknowns, 1>;
  void SpreadCrossings(int side, int kind, const CrossingMatrix& h, const CrossingVector& g);
  std::array<Eigen::Index, 5> PlanePlaces() const;  // of PlaneResidual::by
  void AddPlane();
  void AddGroups();
  void AddRing(const PointGroup* first, const PointGroup* last, const PlaneResidual& unmoved,
               const PlaneResidual& by_offset);
  void AddSidePriors();

  const BoardProblem& problem_;
  const BoardView& view_;
  const BoardState& state_;
  const Rigid3& lidar_from_target_;
  const std::array<double, 4>& side_shift_;
  SharedPlaces places_;
  Eigen::MatrixXd h_;
  Eigen::VectorXd g_;
  double cost_ = 0;
  std::vector<ImageSideEnd> image_side_ends_;
  std::vector<RingOff> rings_off_;
  OwnMatrix of_points_;
  std::vector<FurtherCloud> further_;
};

}  // namespace rgbdt
