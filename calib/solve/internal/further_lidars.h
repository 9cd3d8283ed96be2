#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "calib/solve/internal/joint_problem.h"
#include "calib/solve/internal/joint_solve.h"
#include "calib/solve/internal/view_scatter.h"

namespace rgbdt {

/// The LIDARs beside the reference, added to a problem whose cameras and views are known. Each
/// one's first guess is closed form, from the boards as the two LIDARs have them
/// (GuessFromBoards): by all views together it tells which candidate is the board, and which of the
/// board's turns. A LIDAR without a guess, or with fewer than `min_views` clouds that fit it, takes
/// no part, and its report says why. `reference_offset_sigma_m`: how well the reference's constant
/// range offset is known, of whose ranges a plain board tells nothing but against the further
/// LIDAR's.
void AddLidars(std::vector<LidarViews> lidars, int min_views, double reference_offset_sigma_m,
               JointProblem* joint);

/// In how many views.
int CloudsOf(const BoardProblem& problem, std::size_t lidar);

/// A further LIDAR's cloud of one view, which contradicts the others, takes no part from here on.
void RejectCloud(const Contradiction& worst, JointProblem* joint);

/// That too few views are left, in words.
std::string TooFewClouds(int views, int needed);

}  // namespace rgbdt
