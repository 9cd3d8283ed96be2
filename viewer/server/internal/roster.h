#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <vector>

#include "viewer/server/server.h"

namespace rgbdt::viewer {

/// The browsers' states, for other threads to read: each browser keeps its own line. Thread-safe.
class Roster {
 public:
  std::uint64_t Add(BrowserState state);
  void Update(std::uint64_t line, std::size_t waiting, std::int64_t thinned, double share);
  void Remove(std::uint64_t line);
  std::vector<BrowserState> States() const;  ///< in the order in which they came

 private:
  mutable std::mutex mutex_;
  std::uint64_t last_line_ = 0;
  std::map<std::uint64_t, BrowserState> states_;
};

}  // namespace rgbdt::viewer
