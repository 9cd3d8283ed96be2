#pragma once

#include <string>

#include "calib/model/rig.h"

namespace rgbdt {

/// A board in a few characters, lengths in metres, width before height:
///  - "8x6@0.095,0.85x0.61": 8 x 6 squares of 95 mm on a board of 850 x 610 mm;
///  - "7x5corners@0.095,0.85x0.61": the same by its inner corners, one fewer each way;
///  - "charuco@8x6,0.095,0.07,5X5_100,0.85x0.61": 8 x 6 squares of 95 mm, markers of 70 mm in the
///    white ones; ",legacy" at the end: see Markers::legacy;
///  - "aprilgrid@6x5,0.088,0.3,36h11,0.85x0.7": 6 x 5 tags of 88 mm, 0.3 of that apart;
///  - "velo2cam@0.16" or "fast-calib@0.16": four holes, markers of 160 mm; ",1.5x1.1" at the end:
///    on a board of that size, not 1.4 x 1.0 m;
///  - "plain@1.016x1.016": a board without a pattern.
/// Throws InputError: what is missing, what looks like millimetres, what does not fit on the board.
Target ParseBoard(const std::string& text);

/// The same board in these characters, for messages: its squares and its inner corners.
std::string DescribeBoard(const Target& board);

}  // namespace rgbdt
