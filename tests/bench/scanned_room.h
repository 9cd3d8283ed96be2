#pragma once

#include <cstdint>

#include "calib/model/cloud.h"
#include "tests/bench/turning_scanner.h"

namespace rgbdt::bench {

/// A field of view about straight ahead [rad].
struct Field {
  double wide = 0, high = 0;
};
inline constexpr Field kInView{0.86, 0.64};   ///< every point is seen by both default cameras
inline constexpr Field kAllRound{6.28, 1.1};  ///< some 20% is seen by the one, 15% by the other

/// Some `points` hits in the order in which a LIDAR scans them, column by column of 128 or more,
/// over a tenth of a second; ranges are smooth with a step here and there.
Cloud ScannedRoom(const Field& field, std::int64_t points, Utime utime);

/// An image of the camera, smooth with some texture.
Image PictureOf(const CameraSpec& camera, Utime utime, int variant);

}  // namespace rgbdt::bench
