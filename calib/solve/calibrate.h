#pragma once

#include <string>
#include <vector>

#include "calib/model/calibration.h"
#include "calib/model/method.h"
#include "calib/model/observation.h"
#include "calib/model/rig.h"
#include "calib/solve/first_guess.h"

namespace rgbdt {

struct CalibrateOptions {
  std::string method = kAutoMethod;
  FirstGuessOptions first_guess;  ///< "auto", "plane"
  bool joint = true;              ///< "auto": all cameras together; false: each by itself
  /// "auto", "plane": folds, halves, closure and the next view are worked out, too: for a report.
  bool diagnostics = true;
  int folds = 5;              ///< "auto", "plane": parts of the views, each left out once
  bool smooth_field = false;  ///< "paper": the distance field goes on beyond the image's borders
  int min_views = 3;          ///< usable views for a result that may be called converged
  int max_iterations = 1000;  ///< of Levenberg-Marquardt
  bool wide_start = true;     ///< "paper": solve a second time from a start turned away
  double wide_roll_rad = 0.52359877559829887;  ///< 30 deg about the LIDAR's x (paper, Figure 6)
  double wide_yaw_rad = 0.69813170079773179;   ///< 40 deg about the LIDAR's z

  /// Throws InputError naming the field and its value.
  void Check() const;
};

/// Calibrates every camera of the rig that was observed and judges the result on used and held-out
/// views. "auto": the first guess (first_guess.h) chooses each view's board; then all cameras,
/// boards and nuisances are solved for together (board_problem.h), views and sides that contradict
/// the others are left out by name, and the result has a covariance. Where views left out in turn
/// fit it worse than the first guess by more than chance, the first guess is kept and the status
/// says so. "plane": each
/// camera by the boards' planes alone (by_planes.h). "paper" starts from the hand-measured guess;
/// with wide_start it solves a second time from a start turned away by wide_roll and wide_yaw and
/// reports where that ends. The order of the observations does not matter. A camera without enough
/// views gets its guess and a status that says so; one whose views leave its pose loose a status
/// "degenerate: ..." and no covariance. Throws InputError for an unknown method.
Report Calibrate(const Rig& rig, const std::vector<Observation>& observations,
                 const CalibrateOptions& options = {});

/// Levenberg-Marquardt over the paper's objective from one start: the rotation first, then all six
/// parameters. `used` are usable observations of one camera.
CameraCalibration SolvePaper(const CameraSpec& camera, const std::vector<const Observation*>& used,
                             const Rigid3& start, const CalibrateOptions& options);

/// The status of a camera without enough views.
std::string TooFewViews(std::size_t usable, const CalibrateOptions& options);

/// The guess turned by roll about the LIDAR's x, then yaw about its z.
Rigid3 TurnedStart(const Rigid3& camera_from_lidar, double roll_rad, double yaw_rad);

/// Judges a given calibration on observations; like Calibrate, without the solve.
Report Evaluate(const Rig& rig, const std::vector<Observation>& observations,
                const Calibration& calibration);

}  // namespace rgbdt
