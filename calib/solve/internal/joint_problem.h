#pragma once

#include <vector>

#include "calib/solve/board_problem.h"
#include "calib/solve/camera_views.h"
#include "calib/solve/guess_cameras.h"
#include "calib/solve/lidar_views.h"

namespace rgbdt {

/// Cameras that are solved together.
struct JointProblem {
  BoardProblem problem;
  BoardState start;
  std::vector<GuessedCamera> cameras;     ///< in the order of problem.cameras
  std::vector<LidarViews> lidars{};       ///< in the order of problem.lidars
  std::vector<LidarViews> lidars_left{};  ///< those without a first guess
};

/// What is known of board and beam before any view.
BoardPriors PriorsOf(const Target& target);

/// What a LIDAR's ranges are off by becomes unknown, as far as `range_offset_sigma_m` and the
/// target let it (MakeJointProblem); whether a common offset does.
bool OpenRanges(double range_offset_sigma_m, BoardProblem* problem);

/// Where the LIDAR's clouds tell lasers apart, the radius at which its beams meet becomes an
/// unknown.
void OpenBeams(BoardProblem* problem);

/// The boards of all views used, of cameras that all have a guess; cameras of one name are one that
/// was moved between sessions, and have its lens in common. Each board is brought into one set of
/// axes for all cameras: the target's own, where one of them knows it. A view whose camera takes
/// another board of the cloud than the cameras before it becomes rejected. `range_offset_sigma_m`:
/// how well a constant that ranges may be off by is known; 0: the LIDAR is exact in all. By a plain
/// board it is found only where nothing is known of it (kRangeOffsetSigmaM or more).
JointProblem MakeJointProblem(const Target& target, std::vector<GuessedCamera> cameras,
                              double range_offset_sigma_m);

}  // namespace rgbdt
