#pragma once

#include <string>

#include "calib/files/schema/session_script.h"

namespace rgbdt {

inline constexpr double kPatience = 1e9;  ///< s, with a person who carries the board

/// Whose done ends a step; empty: anybody's.
std::string AnsweredBy(SessionStep::Kind kind);

/// As a person reads it: "next pose".
std::string NameOf(SessionStep::Kind kind);

}  // namespace rgbdt
