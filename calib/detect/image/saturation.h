#pragma once

#include <limits>

#include "calib/model/image.h"

namespace rgbdt {

/// For images that are not saturated anywhere.
inline constexpr double kNeverSaturated = std::numeric_limits<double>::infinity();

/// The grey value (ToGrey) from which on an image only says "at least this bright": 250 of 8 bits;
/// of 16 bits the very brightest value, where more than 100 pixels have it.
double SaturatedFrom(const Image& image);

}  // namespace rgbdt
