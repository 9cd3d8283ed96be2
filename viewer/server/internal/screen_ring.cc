#include "viewer/server/internal/screen_ring.h"

#include <algorithm>
#include <cmath>

namespace rgbdt::viewer {
namespace {

constexpr std::size_t kNewest = 200;
constexpr double kMsPerS = 1000;

// Nearest rank: the smallest value that `share` of all do not exceed.
double Percentile(const std::vector<double>& sorted, double share) {
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size())));
  return sorted[std::max<std::size_t>(rank, 1) - 1];
}

}  // namespace

void ScreenRing::Add(double seconds) {
  const std::lock_guard lock(mutex_);
  if (seconds_.size() < kNewest) {
    seconds_.push_back(seconds);
  } else {
    seconds_[next_] = seconds;
  }
  next_ = (next_ + 1) % kNewest;
}

std::optional<ScreenTimes> ScreenRing::Percentiles() const {
  std::vector<double> sorted;
  {
    const std::lock_guard lock(mutex_);
    sorted = seconds_;
  }
  if (sorted.empty()) return std::nullopt;
  std::sort(sorted.begin(), sorted.end());
  return ScreenTimes{Percentile(sorted, 0.5) * kMsPerS, Percentile(sorted, 0.95) * kMsPerS,
                     static_cast<int>(sorted.size())};
}

}  // namespace rgbdt::viewer
