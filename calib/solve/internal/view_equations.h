#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "calib/solve/board_problem.h"

namespace rgbdt {

inline constexpr int kOwnUnknowns = 10;  ///< of a view: its board's pose, its four sides' shifts

/// One view's normal equations about a state: h x = g, x the step. Its own unknowns come first
/// (board's pose: right delta, lidar_from_target * Exp(delta); then sides' shifts [rad]), then the
/// shared ones (SharedPlaces). Problem and state must outlive it.
class ViewEquations {
 public:
  ViewEquations(const BoardProblem& problem, const BoardState& state, std::size_t view);

  double cost() const { return cost_; }  ///< robust, whitened, squared
  const Eigen::MatrixXd& h() const { return h_; }
  const Eigen::VectorXd& g() const { return g_; }
  const std::vector<ImageSideEnd>& image_side_ends() const { return image_side_ends_; }

 private:
  using Row6 = Eigen::Matrix<double, 1, 6>;
  // What an image's corners depend on: the board's pose, the camera's, its lens, the print.
  static constexpr int kImageUnknowns = 6 + kPoseAndLens + 2;
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
  };
  std::optional<CurveEnd> AtCurveEnd(const BoardImage& image, int side, const Eigen::Vector2d& at,
                                     const Eigen::Vector2d& along) const;
  double OwnSigma(const Crossing& crossing, const CrossingResidual& here) const;
  void AddCrossings();
  void SpreadCrossings(int side, int kind, const Eigen::Matrix<double, 9, 9>& h,
                       const Eigen::Matrix<double, 9, 1>& g);
  void AddPlane();
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
};

}  // namespace rgbdt
