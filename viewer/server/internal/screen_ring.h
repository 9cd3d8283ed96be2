#pragma once

#include <cstddef>
#include <mutex>
#include <optional>
#include <vector>

#include "viewer/server/server.h"

namespace rgbdt::viewer {

/// The newest 200 times from the bus to the screen. Thread-safe.
class ScreenRing {
 public:
  void Add(double seconds);
  std::optional<ScreenTimes> Percentiles() const;  ///< empty: none yet

 private:
  mutable std::mutex mutex_;
  std::vector<double> seconds_;
  std::size_t next_ = 0;
};

}  // namespace rgbdt::viewer
