#pragma once

#include <cmath>

namespace rgbdt {

inline constexpr double kDegreesPerRadian = 180 / M_PI;

}  // namespace rgbdt
