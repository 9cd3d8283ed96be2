#pragma once

#include <vector>

#include "calib/model/markers.h"

namespace rgbdt::simulate {

/// How the markers of a board look.
class MarkerBits {
 public:
  explicit MarkerBits(const Markers& markers);

  /// Cells along a side, border included.
  int cells() const { return cells_; }
  /// Whether a cell is white; columns to the right, rows down, from the marker's top left.
  bool IsWhite(int id, int column, int row) const;

 private:
  int border_, inner_, cells_;
  std::vector<std::vector<bool>> white_;  ///< by number: cells without the border, row by row
};

}  // namespace rgbdt::simulate
