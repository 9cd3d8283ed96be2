#pragma once

#include <optional>
#include <vector>

#include "calib/model/calibration.h"
#include "calib/model/rig.h"
#include "calib/solve/camera_views.h"
#include "calib/solve/guess_cameras.h"
#include "calib/solve/options.h"

namespace rgbdt {

// What the paper leaves open, and what stands here. Its scanner has one line; ours have many: one
// of them is taken, the same in all views, as the scanner does not move; which, see
// LineThroughBoards. Which of the line's points lie on the board a person says there; here the
// detection of the board does. One laser of a spinning LIDAR sees a cone and no plane: the linear
// start takes the plane of least squares through all of the line's points, the refinement takes
// them where they are. How many points and views are enough, and when a result is no calibration,
// is ours: the paper does not say.

struct LineScanOptions {
  int least_points = 8;      ///< of the line on a board
  int least_views = 5;       ///< nine unknowns of the linear start, two a view
  double most_rms_m = 0.05;  ///< distance of the points from the planes beyond: not converged

  /// Throws InputError naming the field and its value.
  void Check() const;
};

/// One line of a scanner on one board, and where the camera sees that board.
struct LineOnBoard {
  Eigen::Vector3d normal{0, 0, 1};  ///< of the board, unit, camera axes
  double offset_m = 0;              ///< normal . p of its points
  /// Sum over the line's points of q q^T, q = (p, 1), LIDAR frame [m].
  Eigen::Matrix4d sums = Eigen::Matrix4d::Zero();
};

/// The line that crosses most boards with `least_points` or more; of several the one nearest to
/// level, where the cone of a ring is most nearly a plane. -1: there is none.
int LineThroughBoards(const std::vector<const CameraView*>& views, int least_points);

/// The paper's linear start: with points P = (X, Z, 1) in the scanner's plane and H = (r1, r3, t),
/// normal . H P = offset for every point, least squares over the nine numbers of H; its first two
/// columns become the nearest rotation. Nothing where the boards leave H loose.
std::optional<Rigid3> LinearStart(const std::vector<LineOnBoard>& lines);

/// Zhang and Pless, Extrinsic calibration of a camera and laser range finder (improves camera
/// calibration), IROS 2004: the linear start, then the sum over all points of the line on all
/// boards of their squared distances from the plane in which the camera sees the board. Rejects the
/// views whose board the line does not cross. No guess has a say. Not solved: fewer views than it
/// needs. The views' groups must be lines (LinesOnBoard).
CameraCalibration SolveLineScan(CameraViews* views, const LineScanOptions& options = {});

/// "line-scan": see Calibrate.
CalibratedCameras CalibrateByLineScan(const Target& target, const CalibrateOptions& options,
                                      std::vector<CameraViews> cameras);

}  // namespace rgbdt
