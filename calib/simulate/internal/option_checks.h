#pragma once

#include "calib/model/check.h"

namespace rgbdt::simulate {

inline constexpr OptionCheck kCheck("simulator");

}  // namespace rgbdt::simulate
