#pragma once

#include <functional>
#include <string>

namespace rgbdt {

/// Called with a line of progress, e.g. "[3/12] view 0003: ...", by one thread at a time.
using Progress = std::function<void(const std::string& line)>;

}  // namespace rgbdt
