#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calib/model/rig.h"
#include "calib/scan_assembly/turned_beams.h"

namespace rgbdt {

struct ScannerGeometryOptions {
  double range_sigma_m = 0.01;     ///< where no flat piece tells the noise
  double lever_prior_m = 0.1;      ///< sigma of the guess' lever arm, along each axis
  double tilt_prior_rad = 0.0873;  ///< sigma of its tilt, about each axis, and of the zero: 5 deg
  double observed_below = 0.03;    ///< of its prior: a direction whose sigma is less is observed
  int min_patches = 10;            ///< pieces of surface that both halves saw
  std::size_t max_beams = 600000;  ///< of more, every second, third, ... is taken
  int max_iterations = 30;         ///< of the last stage

  /// Throws InputError naming the field and its value.
  void Check() const;
};

/// One of the seven unknowns, and whether the sweep tells it.
struct ScannerDirection {
  std::string name;  ///< "lever arm x"
  bool is_angle = false;
  double change = 0;  ///< true less guessed [m or rad]: what was added to the guess
  double sigma = 0;   ///< [m or rad]; the prior's where not observed
  bool observed = false;
  std::string why;  ///< why it is not, and what to do, for a person; empty: it is
};

/// A piece of surface seen by both halves of the scan line, LIDAR frame [m].
struct DoubleSurface {
  int sweep = 0;
  Eigen::Vector3d centre, normal;
  double gap_before_m = 0, gap_after_m = 0;  ///< between the halves, under guess and result
};

/// What a sweep tells of the scanner's place on its motor. motor_from_scanner = Exp(delta) *
/// estimate, delta = (rx, ry, rz [rad], tx, ty, tz [m]) about and along the motor's axes; a seventh
/// unknown is the motor's true angle less the estimated one. Of the seven, rz, tz and the zero are
/// seen by no sweep (README.md beside) and stay as they were guessed.
struct ScannerGeometry {
  TurnedScanner scanner;                     ///< the guess, improved; as it was if not converged
  Eigen::Matrix<double, 7, 7> covariance;    ///< (rx ry rz tx ty tz zero), [rad, m]; with the prior
  std::vector<ScannerDirection> directions;  ///< seven, in the covariance's order
  std::vector<DoubleSurface> surfaces;
  std::size_t beams = 0;                     ///< on these surfaces
  double seen_twice = 0;                     ///< part of all directions that hit something
  double gap_before_m = 0, gap_after_m = 0;  ///< RMS over the surfaces
  double range_sigma_m = 0;                  ///< noise of a range, as found
  bool converged = false;
  std::string detail;  ///< where it is not: what is wrong and what to do

  /// For a person; several lines.
  std::string BriefReport() const;
};

/// Finds where the scanner sits on its motor from sweeps of rooms at rest, one is enough, in which
/// surfaces are seen by both halves of the scan line: by the beams ahead of the motor's axis and,
/// half a turn later, by those behind it. A wrong geometry makes such surfaces double. Robust
/// against edges, moving people and what only one half saw; converges from 20 mm and 2 degrees off.
/// The same input gives the same bits. Throws InputError for an empty input or a bad option.
ScannerGeometry FindScannerGeometry(const TurnedScanner& guess,
                                    const std::vector<TurnedBeams>& sweeps,
                                    const ScannerGeometryOptions& options = {});

}  // namespace rgbdt
