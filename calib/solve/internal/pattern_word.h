#pragma once

#include "calib/model/rig.h"

namespace rgbdt {

/// What a person measures of a target's pattern, for messages: "squares", or "markers" where they
/// stand alone.
inline const char* PatternWord(const Target& target) {
  return target.holes ? "markers" : "squares";
}

}  // namespace rgbdt
