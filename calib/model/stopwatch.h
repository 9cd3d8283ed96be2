#pragma once

#include <chrono>

namespace rgbdt {

/// Computing time [s] since it was made: for the report only, never for a result.
class Stopwatch {
 public:
  double Seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace rgbdt
