#pragma once

#include <optional>
#include <vector>

#include "calib/detect/image/internal/board_map.h"
#include "calib/detect/image/internal/grid_model.h"
#include "calib/detect/image/internal/marker_decode.h"
#include "calib/model/rig.h"

namespace rgbdt {

/// Markers in an image that lie as on the target.
struct MarkerLayout {
  GridModel model;                  ///< from places on the board [squares] to the image
  std::vector<MarkerPlace> agreed;  ///< those that do
};

/// A smooth map of the board, from the places [m] on it of what was seen; see GridModel::Fit.
BoardMap MapByModel(const GridModel& model, const Target& target);

/// Where the markers say that the target is. Those of a grid may be turned in it by quarters, all
/// alike. Nothing where fewer than two, or less than two thirds of them, agree.
std::optional<MarkerLayout> LayOut(const std::vector<SeenMarker>& seen, const Target& target);

}  // namespace rgbdt
