#pragma once

// Inside calib/camera only: a first guess for the intrinsic calibration.

#include <optional>
#include <utility>
#include <vector>

#include "calib/model/intrinsics.h"

namespace rgbdt {

struct IntrinsicsStart {
  Lens lens;  ///< without distortion, principal point in the image's middle
  /// camera_from_target of each view; nothing where no pose puts the board's printed side in front.
  std::vector<std::optional<Rigid3>> poses;
};

/// The focal length that explains most of the views best, of those tried: Zhang's closed form
/// (pinhole) and a range of fields of view. A third of the views may be wrong.
IntrinsicsStart GuessIntrinsics(const IntrinsicsInput& input);

/// camera_from_target from where the target's corners [m] are seen (directions, any length);
/// nothing where the board would be seen from behind.
std::optional<Rigid3> PoseFromDirections(const std::vector<Eigen::Vector3d>& points,
                                         const std::vector<Eigen::Vector3d>& directions);

/// Least and greatest focal length that is tried for this image size [px].
std::pair<double, double> FocalRange(LensChoice choice, int width, int height);

}  // namespace rgbdt
