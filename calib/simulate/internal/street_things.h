#pragma once

#include "calib/simulate/internal/things.h"

namespace rgbdt::simulate {

/// Parked, its nose along x, its middle at the origin: 4.2 m long, 1.75 m wide; its bonnet may be
/// warm.
Thing MakeCar(Dice* draw, const Warmth& warmth);
Thing MakeLampPost(const Warmth& warmth, double arm_towards_y);
/// A traffic sign that looks along -x.
Thing MakeSign(Dice* draw, const Warmth& warmth);
/// Along x, this long.
Thing MakeFence(const Warmth& warmth, double length_m);
/// What stands about near the kerb, at most 0.5 m from its middle: a bollard, bin, cone, crates,
/// planter or a barrier of roadworks.
Thing MakeKerbThing(Dice* draw, const Warmth& warmth, double leaves);

}  // namespace rgbdt::simulate
