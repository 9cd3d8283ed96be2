#include "viewer/server/thinning.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace rgbdt::viewer {
namespace {

constexpr double kSmallestShare = 1.0 / 64;
constexpr double kGrowth = 1.5;
constexpr int kSentBeforeGrowth = 20;
// As many as may be on their way: they were cut to the larger share.
constexpr int kSentBeforeHalving = 4;

}  // namespace

void Thinning::Dropped() {
  if (halved_ && sent_ < kSentBeforeHalving) return;
  share_ = std::max(share_ / 2, kSmallestShare);
  halved_ = true;
  sent_ = 0;
}

double Thinning::share() const {
  const double sweep = std::max(sweep_, last_sweep_);
  const auto wanted = static_cast<double>(wanted_);
  return wanted_ > 0 && sweep > wanted ? std::min(share_, wanted / sweep) : share_;
}

std::size_t Thinning::Cut(const std::string& topic, std::size_t records, std::size_t waiting) {
  CountSweep(topic, records);
  Grow(waiting);
  if (records == 0) return 0;
  const double cut = std::round(share() * static_cast<double>(records));
  return std::clamp(static_cast<std::size_t>(cut), std::size_t{1}, records);
}

void Thinning::CountSweep(const std::string& topic, std::size_t records) {
  if (topic.rfind("sweep/", 0) != 0) return;
  if (topic == "sweep/0") last_sweep_ = std::exchange(sweep_, 0);
  sweep_ += static_cast<double>(records);
}

void Thinning::Grow(std::size_t waiting) {
  ++sent_;
  if (sent_ < kSentBeforeGrowth || waiting > 1) return;
  share_ = std::min(share_ * kGrowth, 1.0);
  halved_ = false;
  sent_ = 0;
}

}  // namespace rgbdt::viewer
