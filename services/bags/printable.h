#pragma once

#include <string>

namespace rgbdt {

/// What a bag says, for a line that a person reads: at most 255 bytes of it, valid UTF-8, without
/// anything that moves a terminal's cursor or begins a line.
std::string Printable(const std::string& text);

}  // namespace rgbdt
