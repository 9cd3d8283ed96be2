#pragma once

#include <optional>

#include "calib/model/calibration.h"
#include "calib/solve/internal/joint_solve.h"

namespace rgbdt {

/// Where the board, held once more, would shrink the worst sigma most: the colouring sigma at 5 m,
/// anywhere in the image, of the camera where it is largest. Tried are board poses 1.5 to 6 m away,
/// tilted and turned, wholly seen by all cameras and about where the LIDAR has seen boards; what
/// each would tell is computed like a view's, with crossings, points and corners as exact as those
/// of the views so far. Nothing where no such pose is seen by all cameras.
std::optional<NextView> FindNextView(const JointResult& result);

}  // namespace rgbdt
