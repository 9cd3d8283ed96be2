#pragma once

#include "calib/simulate/internal/things.h"

namespace rgbdt::simulate {

/// Furniture stands on the floor about its middle; what has a front shows it to -x. Metres.
struct Furniture {
  Thing thing;
  double half_x = 0.5, half_y = 0.5;  ///< of its footprint
};

/// A table with what lies on it: a warm screen, boxes, a plant.
Furniture MakeTableWithThings(Dice* draw, const Warmth& warmth, double leaves);
Furniture MakeChair(Dice* draw, const Warmth& warmth);
Furniture MakeSofa(Dice* draw, const Warmth& warmth);
/// Open to the front, with boxes and books.
Furniture MakeShelf(Dice* draw, const Warmth& warmth);
Furniture MakeCupboard(Dice* draw, const Warmth& warmth);
Furniture MakeRadiator(Dice* draw, const Warmth& warmth);
Furniture MakePottedPlant(Dice* draw, const Warmth& warmth, double leaves);
Furniture MakeBoxes(Dice* draw, const Warmth& warmth);
Furniture MakeFloorLamp(const Warmth& warmth);

}  // namespace rgbdt::simulate
