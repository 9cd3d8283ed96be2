#pragma once

#include <vector>

#include "calib/methods/single_shot/plane_matching.h"
#include "calib/model/calibration.h"
#include "calib/model/rig.h"
#include "calib/solve/camera_views.h"
#include "calib/solve/guess_cameras.h"
#include "calib/solve/options.h"

namespace rgbdt {

struct SingleShotOptions {
  PlaneMatchingOptions matching;
  int rounds = 10;           ///< of matching pieces to boards anew and refining
  double least_share = 0.5;  ///< of the boards that lie on a piece: fewer, and no pose is taken
  /// Another pose with as much of the best one's score: it cannot be told which is right.
  double rival_share = 0.8;

  /// Throws InputError naming the field and its value.
  void Check() const;
};

/// Geiger, Moosmann, Car and Schuster, Automatic camera and range sensor calibration using a single
/// shot, ICRA 2012, of one camera: poses by triples of boards and pieces (plane_matching.h), each
/// refined from points to planes with the pieces matched anew, and of these the one with the best
/// score. No guess has a say, nor which view a board is of; README.md says why that is one shot.
/// Each view's `cloud` becomes the piece that its board lies on, with the board's pose; views
/// without one, or on another view's, are rejected. Of the views held out the nearest piece of
/// their own counts. Not solved: fewer boards than `min_views`, or no pose that has enough of them.
/// Undetermined: two poses fit alike.
CameraCalibration SolveSingleShot(CameraViews* views, int min_views,
                                  const SingleShotOptions& options = {});

/// "single-shot": see Calibrate. Candidates of the clouds must be pieces (PlanarPatches).
CalibratedCameras CalibrateBySingleShot(const Target& target, const CalibrateOptions& options,
                                        std::vector<CameraViews> cameras);

}  // namespace rgbdt
