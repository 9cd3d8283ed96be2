#pragma once

#include <functional>

namespace rgbdt {

/// Calls work(0) ... work(count - 1), each once, on `threads` threads (0: as many as the machine
/// has). Which thread does which is left open: work must depend on its number only.
void ForEach(int count, int threads, const std::function<void(int)>& work);

}  // namespace rgbdt
