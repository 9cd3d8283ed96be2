#include "viewer/server/internal/thinning.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string_view>
#include <utility>

namespace rgbdt::viewer {
namespace {

constexpr std::string_view kSweepTopic = "sweep/";
constexpr double kSmallestShare = 1.0 / 64;
constexpr double kGrowth = 1.5;
constexpr int kSentBeforeGrowth = 20;
// As many as may be on their way: they were cut to the larger share.
constexpr int kSentBeforeHalving = 4;

std::size_t CutTo(double share, std::size_t records) {
  if (records == 0) return 0;
  const double cut = std::round(share * static_cast<double>(records));
  return std::clamp(static_cast<std::size_t>(cut), std::size_t{1}, records);
}

}  // namespace

void Thinning::Dropped() {
  if (halved_ && sent_ < kSentBeforeHalving) return;
  share_ = std::max(share_ / 2, kSmallestShare);
  halved_ = true;
  sent_ = 0;
}

double Thinning::share() const { return std::min(share_, WantedShare()); }

double Thinning::WantedShare() const {
  const double sweep = std::max(sweep_, last_sweep_);
  const auto wanted = static_cast<double>(wanted_);
  return wanted_ > 0 && sweep > wanted ? wanted / sweep : 1;
}

std::size_t Thinning::Cut(const std::string& topic, std::size_t records, std::size_t waiting) {
  CountSweep(topic, records);
  Grow(waiting);
  return CutTo(share(), records);
}

std::size_t Thinning::Wanted(std::size_t records) const { return CutTo(WantedShare(), records); }

// Any part of a sweep may have been dropped: another sweep begins where the parts do not go up.
void Thinning::CountSweep(const std::string& topic, std::size_t records) {
  if (topic.rfind(kSweepTopic, 0) != 0) return;
  const int part = std::atoi(topic.c_str() + kSweepTopic.size());
  if (part <= part_) last_sweep_ = std::exchange(sweep_, 0);
  part_ = part;
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
