#include "services/drivers/livox/livox_sweeps.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calib/model/livox.h"

namespace rgbdt {
namespace {

constexpr Utime kMostGapUs = 2000;         // from packet to packet; 0.2 to 0.5 ms is usual
constexpr Utime kMostAwayUs = 10'000'000;  // farther: somebody set a clock
// Of a cloud. None sends a quarter of it in a second (Avia: 240,000 beams): the clock stands still.
constexpr std::size_t kMostPoints = 1'000'000;

// What its own clock says, where that follows the world's.
std::optional<Utime> Utc(const livox::Packet& packet, Utime arrival) {
  switch (packet.clock) {
    case livox::Clock::kUtc:
      return packet.stamp_ns / 1000;
    case livox::Clock::kPtp:
      return PtpToUtc(packet.stamp_ns / 1000, arrival);
    case livox::Clock::kSinceStart:
      break;
  }
  return std::nullopt;
}

}  // namespace

// A packet arrives once its last beam was measured.
void LivoxSweeps::FollowClock(const livox::Packet& packet, Utime arrival) {
  if (Utc(packet, arrival)) return;
  const bool stepped = !fit_.Add(packet.stamp_ns, arrival, static_cast<Utime>(packet.duration_us));
  if (stepped || fit_of_cloud_.size() == 0) fit_of_cloud_ = fit_;
}

Utime LivoxSweeps::TimeOf(const livox::Packet& packet, Utime arrival) const {
  if (const auto utc = Utc(packet, arrival)) return *utc;
  return fit_of_cloud_.ToHost(static_cast<double>(packet.stamp_ns)).value();
}

std::optional<Cloud> LivoxSweeps::Add(const livox::Packet& packet, Utime arrival) {
  FollowClock(packet, arrival);
  Utime utime = TimeOf(packet, arrival);
  std::optional<Cloud> done;
  const Utime gap = utime - next_;
  const bool full = cloud_.points.size() + packet.points.size() > kMostPoints;
  if (any_ && (full || std::abs(gap) > kMostAwayUs)) {
    cloud_ = Cloud();
    ++left_out_;
    any_ = false;
  } else if (any_ && gap < -kMostGapUs) {
    return std::nullopt;
  }
  if (any_ && gap > kMostGapUs) {
    lost_us_ += gap;
    cloud_lost_us_ += std::max<Utime>(0, std::min(utime, begun_ + kLivoxCloudUs) - next_);
  }
  if (any_ && utime >= begun_ + kLivoxCloudUs) {
    done = Take();
    any_ = false;  // a gap that the next one begins with is not in it
  }
  if (!any_) {
    any_ = true;
    fit_of_cloud_ = fit_;
    begun_ = utime = TimeOf(packet, arrival);
    cloud_lost_us_ = 0;
  }
  for (const livox::Point& point : packet.points) {
    cloud_.points.push_back(point.place_m);
    cloud_.intensity.push_back(static_cast<float>(point.reflectivity) / 255);
    cloud_.utime.push_back(utime + static_cast<Utime>(point.time_us));
  }
  dropped_ += packet.dropped;
  next_ = utime + static_cast<Utime>(packet.duration_us);
  return done;
}

std::optional<Cloud> LivoxSweeps::Finish() {
  if (!any_ || next_ - begun_ < kLivoxCloudUs - kMostGapUs) return std::nullopt;
  any_ = false;
  return Take();
}

std::optional<Cloud> LivoxSweeps::Take() {
  Cloud cloud = std::exchange(cloud_, Cloud());
  if (cloud_lost_us_ > kLivoxCloudUs / 10) {
    ++left_out_;
    return std::nullopt;
  }
  if (cloud.points.empty()) return std::nullopt;
  cloud.sweep_utime = begun_;
  cloud.lines = 1;
  cloud.beams = static_cast<int>(cloud.points.size());
  cloud.organised = false;
  return cloud;
}

}  // namespace rgbdt
