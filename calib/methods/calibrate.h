#pragma once

#include <string>
#include <vector>

#include "calib/model/calibration.h"
#include "calib/model/rig.h"
#include "calib/model/view_detection.h"
#include "calib/solve/options.h"

namespace rgbdt {

/// Calibrates every camera of the rig that was observed and judges the result on used and held-out
/// views. "auto": the first guess (first_guess.h) chooses each view's board; then all cameras,
/// boards and nuisances are solved for together (board_problem.h), views and sides that contradict
/// the others are left out by name, and the result has a covariance. Where views left out in turn
/// fit it worse than the first guess by more than chance, the first guess is kept and the status
/// says so. "plane": each
/// camera by the boards' planes alone (by_planes.h). "line-scan", "bearing-angle", "single-shot":
/// published methods to compare with (line_scan/, bearing_angle/, single_shot/), whose detections
/// must be made by the same method. "paper" starts from the hand-measured guess;
/// with wide_start it solves a second time from a start turned away by wide_roll and wide_yaw and
/// reports where that ends. The order of the detections does not matter. A camera without enough
/// views gets its guess and a status that says so; one whose views leave its pose loose a status
/// "degenerate: ..." and no covariance. Throws InputError for an unknown method.
Report Calibrate(const Rig& rig, const std::vector<ViewDetection>& detections,
                 const CalibrateOptions& options = {});

/// Judges a given calibration on detections; like Calibrate, without the solve.
Report Evaluate(const Rig& rig, const std::vector<ViewDetection>& detections,
                const Calibration& calibration);

}  // namespace rgbdt
