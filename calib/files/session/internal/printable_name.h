#pragma once

#include <algorithm>
#include <string>

#include "calib/model/text.h"

namespace rgbdt {

/// What a stranger's session calls a view or a file, for a line that a person reads: valid UTF-8,
/// nothing in it that moves a terminal's cursor or begins a line.
inline std::string PrintableName(const std::string& name) {
  std::string printable = ValidUtf8(name);
  const auto is_control = [](unsigned char c) { return c < ' ' || c == 0x7f; };
  std::replace_if(printable.begin(), printable.end(), is_control, '?');
  return printable;
}

/// Whether reports, pages and terminals show it as it is.
inline bool IsPrintable(const std::string& name) { return PrintableName(name) == name; }

}  // namespace rgbdt
