#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "calib/model/cloud.h"
#include "calib/model/rig.h"
#include "calib/model/view_detection.h"
#include "calib/simulate/internal/noise.h"
#include "calib/simulate/options.h"
#include "tests/study/true_board.h"

namespace rgbdt::study {

/// What a LIDAR's beam does at a board's edge: the noise model of the large studies. It stands here
/// by itself, not taken from the estimator (BeamEdgeOptions), which is to be judged by it.
struct BeamModel {
  double range_sigma_m = 0.010;
  double range_offset_m = 0;  ///< true range minus measured, of all
  /// What is known of it beforehand, about zero; 0: exact. For the bound and the rig.
  double range_offset_sigma_m = 0;
  /// Further, of each ring: true minus measured; empty: rings do not differ.
  std::vector<double> ring_offset_m;
  double dark_range_m = 0;  ///< black squares are measured this much farther than white ones
  double beams_meet_m = 0;  ///< radius at which a spinning LIDAR's beams have one height
  /// What is known of each of these beforehand, about zero; 0: exact. For the bound.
  double ring_offset_sigma_m = 0, dark_range_sigma_m = 0, beams_meet_sigma_m = 0;
  double outline_sigma_m = 0;       ///< of each of the board's sides' places against the pattern
  double class_sigma_rad = 0.6e-3;  ///< each class of crossing's shift, drawn once a session
  double class_prior_rad = 0.6e-3;  ///< what is known of it beforehand: for the bound
  double side_sigma_rad = 0.3e-3;   ///< each side's own shift, drawn for every view
  double blur_rad = 0.4e-3;         ///< how exactly one beam tells inside from outside
  double thickness_m = 0.015;       ///< of the board
  /// What is known of the thickness beforehand: for the bound.
  double thickness_sigma_m = 0.010;
  double rim_m = 0.04;  ///< nearer than this to a side, a range is not trusted
};

/// Whole beams of a LIDAR: a part of the sensor's grid.
struct BeamWindow {
  int rows = 0, columns = 0;
  std::vector<Eigen::Vector3d> directions;  ///< unit, LIDAR frame; row by row
  std::vector<std::uint16_t> ring;          ///< the laser of each beam; a scanner's: its number
  std::vector<bool> on;                     ///< which of them the board stops

  std::size_t At(int row, int column) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
           static_cast<std::size_t>(column);
  }
};

/// Where a beam meets the board, or beyond it its surface drawn out; target frame.
struct PlanePlace {
  Eigen::Vector2d place{0, 0};
  double range_m = 0;
  Eigen::Vector3d direction{0, 0, 1};  ///< of the beam
  bool ahead = false;                  ///< false: it does not meet the plane's front
};
/// `beams_meet_m`: of the LIDAR (BeamModel); the beam starts at its height on the axis.
PlanePlace MeetBoard(const TrueBoard& board, const Rigid3& lidar_from_target,
                     const Eigen::Vector3d& direction, double beams_meet_m);

/// Whether a place on the board [m] is black as it is printed: every other square, and the border.
bool IsBlack(const Target& target, const Eigen::Vector2d& place);

/// Outward normal of side 0 to 3 (top, right, bottom, left) and its distance from the centre.
Eigen::Vector2d SideNormal(int side);
double SideDistance(const TrueBoard& board, int side);

/// How far out a side seems [m]: for each radian of a beam's shift, which a slant draws out on the
/// plane; and for each metre of thickness, where the rim faces the LIDAR.
double PerRadian(const PlanePlace& beam, int side);
double PerThickness(const PlanePlace& beam, int side);

/// The session's draw of each class's shift [rad], by CrossingKind - 1.
using ClassShifts = std::array<double, 3>;
ClassShifts DrawClassShifts(const BeamModel& model, const simulate::Noise& noise);

/// One view of the board as the noise model has it.
struct SampledCloud {
  BeamWindow beams;
  std::array<CrossingKind, 4> behind{};  ///< what lies behind each side
  Cloud cloud;                           ///< organised, as large as the window
};

/// The beams of `lidar` about the board, each on the board or beyond it by where it meets the
/// board, the sides displaced by what `model`, `shifts` and `noise` draw.
SampledCloud SampleCloud(const simulate::Options& lidar, const TrueBoard& board,
                         const Rigid3& lidar_from_target, const BeamModel& model,
                         const ClassShifts& shifts, const simulate::Noise& noise);

}  // namespace rgbdt::study
