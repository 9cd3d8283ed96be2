#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calib/model/image.h"
#include "calib/model/rig.h"

namespace rgbdt {

/// Whether images show the checkerboard that a person says.
struct BoardCheck {
  bool found = false;             ///< in one of the images at least
  std::optional<Target> instead;  ///< where not: one of a square more or fewer each way, if that is
  std::string why;                ///< where not: of the last image
};

/// Inner corners are easily taken for squares, and the other way round: where none of these images
/// of `camera` shows the target, the next larger and the next smaller board are looked for.
BoardCheck CheckBoard(const CameraSpec& camera, const Target& target,
                      const std::vector<Image>& images);

/// What such a check found instead, in words: "the images show 8 x 6 squares (7 x 5 inner corners),
/// not 7 x 5: count squares, not inner corners".
std::string OtherBoard(const Target& stated, const BoardCheck& check);

}  // namespace rgbdt
