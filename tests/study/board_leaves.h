#pragma once

#include <cstddef>
#include <vector>

#include "calib/model/rig.h"
#include "tests/study/sampled_sessions.h"

namespace rgbdt::study {

/// Where a row or column of beams leaves the board.
struct Leave {
  std::size_t last = 0;    ///< last beam on the board: the window's index
  int side = 0;            ///< that it crosses
  double width_m = 0;      ///< of the interval, across the side
  bool along_row = false;  ///< the two beams are neighbours in a row
  std::size_t gap = 0;     ///< the last beam's column (along a row) or row
  int of_beam = 1;         ///< crossings of the same side by the same last beam
  int in_gap = 1;          ///< crossings of the same side in the same gap
};

/// All that a view tells of the board's sides, but near its corners, where a side may be either.
std::vector<Leave> LeavesOf(const TrueBoard& board, double beams_meet_m, const SampledView& view);

}  // namespace rgbdt::study
