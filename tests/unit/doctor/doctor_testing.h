#pragma once

#include <gmock/gmock.h>

#include "services/doctor/checks.h"

namespace rgbdt {

inline auto Is(Finding::Level level) { return ::testing::Field(&Finding::level, level); }

/// A finding of that level with these words in it, and in what mends it.
inline auto Says(Finding::Level level, const std::string& what, const std::string& fix) {
  using ::testing::Field;
  using ::testing::HasSubstr;
  return ::testing::AllOf(Is(level), Field(&Finding::what, HasSubstr(what)),
                          Field(&Finding::fix, HasSubstr(fix)));
}

inline constexpr auto kOk = Finding::Level::kOk;
inline constexpr auto kWarning = Finding::Level::kWarning;
inline constexpr auto kProblem = Finding::Level::kProblem;

}  // namespace rgbdt
