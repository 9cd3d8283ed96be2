#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "calib/detect/cloud/board_crossings.h"
#include "calib/model/beam_priors.h"

namespace rgbdt {

/// Physics of a beam that has a width; the values' reasons stand in beam_priors.h.
struct BeamEdgeOptions {
  double class_sigma_rad = kViewClassShiftSigmaRad;  ///< each class's shift (CrossingKind)
  double side_sigma_rad = kSideShiftSigmaRad;        ///< each side's own shift
  double blur_rad = kCrossingBlurRad;  ///< how exactly one beam tells inside from outside
  /// Prior of the board's thickness.
  double thickness_m = kBoardThicknessM, thickness_sigma_m = kBoardThicknessSigmaM;
};

/// A rectangle of known size in a plane. Its sides: 0 top (v negative), 1 right, 2 bottom, 3 left.
struct FlatRectangle {
  Eigen::Vector2d centre{0, 0};
  double angle_rad = 0;  ///< of its width's direction from u towards v
  double coverage = 0;   ///< part of its outline that crossings lie on
  std::array<double, 4> side_coverage{};
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< of centre (u, v) and angle
  std::array<double, 3> shift_rad{}, shift_sigma_rad{};  ///< of each class of crossing
  double thickness_m = 0, thickness_sigma_m = 0;
  /// How far the shifts and the thickness are from their priors, in sigmas: the root of the priors'
  /// cost. A board of another size makes itself fit by them.
  double prior_deviation = 0;
  double misfit = 0;  ///< mean square of what crossings are off over what they state; 1: as stated
  std::vector<int> side;  ///< by crossing: the side that it lies on; -1: none
  /// By crossing: half of its interval across its side, and the sigma of the side's place that it
  /// gives, errors that it shares with others taken into account.
  std::vector<double> half_width_m, sigma_m;
};

/// The rectangle that most crossings lie on, by voting: for each direction the crossings that face
/// it add up where they are, those that face away one width farther. None where they add up to
/// less than half of the outline. Not fooled by what sticks to the board: it takes the best
/// rectangle, not the piece's extent. Where of two opposite sides only one is seen, there is one
/// rectangle for each that might be it.
std::vector<FlatRectangle> VoteForRectangles(const std::vector<FlatCrossing>& crossings,
                                             double width_m, double height_m);

/// Least squares over the crossings' intervals from a rectangle nearby: place, angle, one shift a
/// class of crossing and one a side, and the thickness of the board's rim. Crossings far off are
/// left out. Two crossings of one cell share their error, and count as one together. Its
/// covariance carries the shifts' priors.
FlatRectangle RefineRectangle(const std::vector<FlatCrossing>& crossings, double width_m,
                              double height_m, const FlatRectangle& start,
                              const BeamEdgeOptions& options = {});

}  // namespace rgbdt
