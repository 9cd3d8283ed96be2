#pragma once

#include <optional>

#include "calib/model/cloud.h"
#include "calib/model/pose_track.h"

namespace rgbdt {

/// A sweep of a rig that moved, as the LIDAR would have seen it from where it was at `moment`: each
/// point, and each miss's direction, taken there by the poses. It stays organised. A sweep without
/// times, and one while no poses come, is given back as it is. Nothing where the poses do not tell
/// where the rig was at the moment, or at a tenth of the points' times or more; single points of
/// such times become misses without a direction.
std::optional<Cloud> AsSeenAt(Cloud cloud, const PoseTrack& poses, Utime moment);

}  // namespace rgbdt
