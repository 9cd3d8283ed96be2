#pragma once

#include <cstddef>
#include <vector>

#include "calib/solve/internal/joint_problem.h"
#include "calib/solve/internal/joint_solve.h"
#include "calib/solve/internal/view_scatter.h"

namespace rgbdt {

/// The LIDARs beside the reference, added to a problem whose cameras and views are known. Each
/// one's first guess is closed form, from the boards as the two LIDARs have them
/// (GuessFromBoards): by all views together it tells which candidate is the board, and which of the
/// board's turns. A LIDAR without a guess takes no part, and its report says why.
void AddLidars(std::vector<LidarViews> lidars, int min_views, JointProblem* joint);

/// In how many views.
int CloudsOf(const BoardProblem& problem, std::size_t lidar);

/// A further LIDAR's cloud of one view, which contradicts the others, takes no part from here on.
void RejectCloud(const Contradiction& worst, JointProblem* joint);

/// Each further LIDAR's report: its pose with covariance, what was found of it.
std::vector<LidarReport> ReportsOfLidars(const JointResult& result);

}  // namespace rgbdt
