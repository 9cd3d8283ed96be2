#pragma once

#include <vector>

#include "calib/detect/cloud/board_crossings.h"
#include "calib/detect/cloud/rectangle_fit.h"
#include "calib/model/cloud.h"
#include "calib/model/rig.h"

namespace rgbdt {

/// Where points that keep to no grid (a Livox's) leave a board, told by the points alone: each side
/// is cut into strips across it, and in each the side lies between the outermost point on the plane
/// and the innermost one beyond. Of points that lie without order it is anywhere between the two
/// with the same chance. Where noise has mixed them it is where the fewest are on the wrong side.
/// Where nothing returned from beyond, it is as far behind the outermost as points on the board are
/// from any place on it: by the moments of their gaps X, E X^2 / (2 E X) in the mean, with variance
/// E X^3 / (3 E X) less that squared (the recurrence time of a renewal process). Strips that
/// something stands before are left out.
///
/// `near`: the rectangle, a few centimetres and degrees off at most. Beams start at the origin.
/// Each crossing stands for itself: none shares its cell or gap.
std::vector<FlatCrossing> ScatteredCrossings(const Cloud& cloud, const Plane& plane,
                                             const PlaneFrame& frame, const FlatRectangle& near,
                                             const Target& target, double sigma_m);

/// The rectangle moved to the middle between opposite sides, each where the median of its crossings
/// is: what sticks to half of a side does not move it.
FlatRectangle Centred(FlatRectangle near, const std::vector<FlatCrossing>& crossings,
                      const Target& target);

}  // namespace rgbdt
