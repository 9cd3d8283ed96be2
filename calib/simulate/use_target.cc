#include "calib/simulate/use_target.h"

namespace rgbdt::simulate {

void UseTarget(const Target& target, BoardOptions* board) {
  board->squares_x = target.squares_x;
  board->squares_y = target.squares_y;
  board->square_m = target.square_m;
  board->markers = target.markers;
  board->holes = target.holes;
  board->width_m = target.width_m;
  board->height_m = target.height_m;
}

}  // namespace rgbdt::simulate
