#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "calib/model/beam_priors.h"
#include "calib/model/rig.h"
#include "calib/model/view_detection.h"

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
  kPrintWidth,  ///< the pattern's width over what its squares make it, less one
  kPrintHeight,
  kBeamsMeet,  ///< RangeErrors::beams_meet_m
  kFringe,     ///< by how much more a board looks too large at each side, at any range
  kBowX,       ///< the board's shape (Target::BowFactors) [m]
  kTwist,
  kBowY,
  kSharedUnknowns
};

/// Of a board that is taken for flat.
inline constexpr double kNoBowSigmaM = 1e-9;

/// Whether an unknown tells of the LIDAR that sees the board, so that each LIDAR has its own; all
/// others are the board's.
constexpr bool IsOfLidar(int unknown) {
  return unknown <= kMergedShift || unknown == kRangeOffset || unknown == kBeamsMeet ||
         unknown == kFringe;
}

/// What is known beforehand of the solve's unknowns besides the poses; the values' reasons stand in
/// beam_priors.h. All but the thickness about zero.
struct BoardPriors {
  double class_sigma_rad = kSharedClassShiftSigmaRad;  ///< shift of each class (CrossingKind)
  double side_sigma_rad = kSideShiftSigmaRad;          ///< further shift of each side in each view
  double blur_rad = kCrossingBlurRad;  ///< how exactly one beam tells inside from outside
  double thickness_m = kBoardThicknessM, thickness_sigma_m = kBoardThicknessSigmaM;
  double outline_sigma_m = kOutlineSigmaM;  ///< each side's place against the pattern
  /// Further displacement of each side's ends in each image, on the board.
  double image_side_sigma_m = 0;
  double range_offset_sigma_m = kNoRangeOffsetSigmaM;  ///< true range minus measured
  double print_sigma = kNoPrintSigma;                  ///< Target::print_sigma
  double beams_meet_sigma_m = kNoBeamsMeetSigmaM;
  double fringe_sigma_m = kNoFringeSigmaM;
  double bow_sigma_m = kNoBowSigmaM;  ///< of each of the three
  /// Further range offsets, of each ring and of each octave of intensity (RangeTerms).
  double ring_sigma_m = 0, octave_sigma_m = 0;
  double ring_view_sigma_m = 0;  ///< further still, of each ring in each view; 0: there is none

  std::array<double, kSharedUnknowns> Means() const;
  double Sigma(int unknown) const;
};

/// How exactly the mean of the rings' offsets is held to zero, and of the octaves' [m].
inline constexpr double kMeanTermSigmaM = 1e-4;

/// Which range offsets are unknowns besides the common one (RangeErrors): of single rings, and of
/// octaves of intensity. None, unless the data ask for them.
struct RangeTerms {
  std::vector<int> rings;   ///< rising
  double first_octave = 0;  ///< log2 of intensity, where the first one's offset holds
  std::size_t octaves = 0;  ///< one apart; between them the offset is interpolated
  /// By term, its share of all points: of the rings they add up to 1, of the octaves, too. What all
  /// points have in common is the common offset's: the mean of the rings' offsets by these weights
  /// is zero, and that of the octaves'.
  std::vector<double> shares;

  std::size_t Count() const { return rings.size() + octaves; }

  /// Of a group of points: which of the terms, in this order rings and octaves, count how much.
  struct Part {
    std::size_t term = 0;
    double weight = 0;
  };
  static constexpr int kMostParts = 3;
  struct Parts {
    std::array<Part, kMostParts> all;
    std::size_t count = 0;
    const Part* begin() const { return all.data(); }
    const Part* end() const { return all.data() + count; }
  };
  Parts PartsOf(const PointGroup& group) const;
};

/// A detector's errors within one image are partly correlated, more than their residuals show:
/// poses from rendered colour images are off by about half as much again as the corners' scatter
/// has it (scripts/study detection, corners; those from thermal ones are not). Sigmas of corners
/// are enlarged by this factor.
inline constexpr double kCornerSigmaInflation = 1.4;

/// The three of the shared unknowns that are the board's shape (Target::BowFactors) [m].
Eigen::Vector3d BowOf(const std::array<double, kSharedUnknowns>& shared);
/// How far behind its mean plane a board lies at (x, y) of the target, by these, and its slope
/// along the target's x and y.
double BowAt(const Target& target, const std::array<double, kSharedUnknowns>& shared,
             const Eigen::Vector2d& at);
Eigen::RowVector2d BowSlope(const Target& target, const std::array<double, kSharedUnknowns>& shared,
                            const Eigen::Vector2d& at);

/// The target with its pattern as large as the shared unknowns have it.
Target PrintedAs(const Target& target, const std::array<double, kSharedUnknowns>& shared);

/// A crossing against its side. All on the board, radians and metres, as many as they are at the
/// range at which the crossing was seen: what a beam tells is a direction. Metres on the board
/// where a state has it would be fewer the nearer that is, and a solve that knows of no ranges
/// (edges alone) would draw it near.
struct CrossingResidual {
  double beyond_m = 0;                    ///< outwards of the side, shifts taken off
  double sigma_m = 0;                     ///< of this crossing alone
  Eigen::Matrix<double, 1, 6> by_target;  ///< d beyond / d delta, lidar_from_target * Exp(delta)
  double per_outline = 0;    ///< metres that a side lies farther out for each metre of its outline
  double per_rad = 0;        ///< metres that a side seems farther out for each radian of shift
  double per_thickness = 0;  ///< the same for each metre of thickness
  double by_beams_meet = 0;  ///< d beyond / d kBeamsMeet
  Eigen::RowVector3d per_bow{0, 0, 0};  ///< d beyond / d kBowX, kTwist, kBowY
  double per_fringe = 0;  ///< metres that a side seems farther out for each metre of kFringe
};
CrossingResidual ResidualOf(const Target& target, const BoardPriors& priors,
                            const Crossing& crossing, const Rigid3& lidar_from_target,
                            const std::array<double, kSharedUnknowns>& shared, double side_shift);

/// The points on the board against its plane: x' CloudEdges::scatter x is the sum of their squared
/// distances from it. With n the board's normal, x = (n + b lean, n . (centre + b beam - t)). A
/// range offset b lies along each point's own beam, not the centre's: across the board that leans
/// the plane, and its mean is shorter. `beam` is the mean of the points' unit beams, to the second
/// order in the board's size; `lean`, to the first, how a beam's part along n changes across the
/// board. It has no part along n: there the scatter is noise, which would draw b towards the LIDAR.
/// Beams that meet at radius m move points by -m tan(elevation) along the LIDAR's z, and across the
/// board lean the plane likewise. Of a group of points (PointGroup) x is the same, with its own b.
struct PlaneResidual {
  Eigen::Vector4d x;
  /// d x / d: the delta of lidar_from_target * Exp(delta) about the target's x, about its y, along
  /// its z; the range offset; where beams meet.
  Eigen::Matrix<double, 4, 5> by;
};
PlaneResidual ResidualOf(const CloudEdges& cloud, const Rigid3& lidar_from_target,
                         double range_offset_m, double beams_meet_m);

/// A crossing's sigma [m] by the cloud's own pose, nothing where its beam misses the board there.
/// For weights: one that changed with the board's place would be an objective of its own.
std::optional<double> SigmaByCloud(const Target& target, const BoardPriors& priors,
                                   const Crossing& crossing, const CloudEdges& cloud,
                                   const std::array<double, kSharedUnknowns>& shared);

/// Outward normal of a side, target axes. Sides: 0 top (y negative), 1 right, 2 bottom, 3 left.
Eigen::Vector2d OutwardOf(int side);

/// What a whitened residual, squared, costs and weighs: full weight up to 3 sigma, then as in a
/// Student-like tail, so that what is plainly wrong has next to no say.
double RobustCost(double squared);
double RobustWeight(double squared);

}  // namespace rgbdt
