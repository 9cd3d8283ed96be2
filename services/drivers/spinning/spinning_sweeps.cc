#include "services/drivers/spinning/spinning_sweeps.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "calib/model/errors.h"

namespace rgbdt {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr std::size_t kMostColumns = 20'000;  // a head that hardly turns
constexpr double kMostPassedUs = 5e5;         // from packet to packet

// From the back on, 0 to a full turn.
double FromSeam(double azimuth_rad) { return std::fmod(azimuth_rad + 3 * M_PI, 2 * M_PI); }

spinning::Return Brighter(const spinning::Return& a, const spinning::Return& b) {
  if (a.range_m == 0 || b.range_m == 0) return a.range_m == 0 ? b : a;
  return b.reflectivity > a.reflectivity ? b : a;
}

}  // namespace

SpinningSweeps::SpinningSweeps(spinning::Angles angles, spinning::Lens lens)
    : angles_(std::move(angles)), lens_(lens) {
  std::vector<std::size_t> order(channels());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return angles_.elevation_rad[a] < angles_.elevation_rad[b];
  });
  ring_.resize(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) ring_[order[i]] = i;
}

// Of the revolution under way; the next one begins at the seam.
void SpinningSweeps::Leave() {
  left_out_ += whole_ ? 1 : 0;
  columns_.clear();
  whole_ = false;
  last_from_seam_ = -1;
}

// What never came between the packet before and this one. Azimuths tell it within a turn, whatever
// the clock; of longer gaps only the time does.
void SpinningSweeps::CountLost(const spinning::Packet& packet, double utime) {
  const double passed_us = utime - std::exchange(last_utime_, utime);
  if (last_from_seam_ < 0 || packet.columns.empty()) return;
  const spinning::Column &first = packet.columns.front(), &last = packet.columns.back();
  const double from_seam = FromSeam(first.azimuth_rad);
  const double gap = std::remainder(from_seam - last_from_seam_, 2 * M_PI);
  double step = std::remainder(last.azimuth_rad - first.azimuth_rad, 2 * M_PI) /
                static_cast<double>(std::max<std::size_t>(packet.columns.size() - 1, 1));
  double column_us = (last.time_us - first.time_us) /
                     static_cast<double>(std::max<std::size_t>(packet.columns.size() - 1, 1));
  if (packet.columns.size() == 1) {       // about the step before, unless something was lost
    constexpr double kRoundedRad = 2e-4;  // azimuths are of 0.01 degrees
    if (gap > 0 && gap < 1.5 * last_step_ + kRoundedRad) last_step_ = gap;
    step = last_step_;
    column_us = packet.column_us;
  }
  if (step <= 0) return;  // the head stands
  const double half_turn_us = M_PI / step * column_us;
  if (passed_us < 0 || passed_us > std::min(half_turn_us, kMostPassedUs) || gap < -step) {
    Leave();
  } else if (whole_ && gap > 1.5 * step) {
    lost_columns_ += std::llround(gap / step) - 1;
  }
}

std::vector<Cloud> SpinningSweeps::Add(const spinning::Packet& packet, Utime arrival) {
  std::vector<Cloud> done;
  if (!packet.columns.empty() && packet.columns.front().returns.size() != channels()) {
    throw InputError("a packet of " + std::to_string(packet.columns.front().returns.size()) +
                     " channels; the angles are of " + std::to_string(channels()));
  }
  const auto utime = static_cast<double>(packet.utime.value_or(arrival));
  CountLost(packet, utime);
  for (const spinning::Column& column : packet.columns) {
    Fired fired{column.azimuth_rad, utime + column.time_us, column.returns};
    for (std::size_t i = 0; i < column.second_returns.size(); ++i) {
      fired.returns[i] = Brighter(fired.returns[i], column.second_returns[i]);
    }
    const double from_seam = FromSeam(fired.azimuth_rad);
    if (last_from_seam_ >= 0 && from_seam < last_from_seam_ - M_PI) {
      if (whole_ && columns_.size() > 1) done.push_back(Revolution());
      columns_.clear();
      whole_ = true;
    } else if (columns_.size() >= kMostColumns) {
      columns_.clear();
      whole_ = false;
    }
    last_from_seam_ = from_seam;
    if (whole_) columns_.push_back(std::move(fired));
  }
  return done;
}

Utime SpinningSweeps::begun() const {
  return columns_.empty() ? 0 : static_cast<Utime>(std::llround(columns_.front().utime));
}

Cloud SpinningSweeps::Revolution() const {
  const std::size_t beams = columns_.size(), size = channels() * beams;
  Cloud cloud;
  cloud.sweep_utime = begun();
  cloud.lines = static_cast<int>(channels());
  cloud.beams = static_cast<int>(beams);
  cloud.points.assign(size, {kNan, kNan, kNan});
  cloud.directions.assign(size, {kNan, kNan, kNan});
  cloud.intensity.resize(size);
  cloud.utime.resize(size);
  cloud.ring.resize(size);
  if (lens_.up_m != 0) {
    cloud.origins.assign(channels(), {0, 0, static_cast<float>(lens_.up_m)});
  }
  const double step =
      (FromSeam(columns_.back().azimuth_rad) - FromSeam(columns_.front().azimuth_rad)) /
      static_cast<double>(beams - 1);
  const auto n = static_cast<std::int64_t>(beams);
  for (std::size_t channel = 0; channel < channels(); ++channel) {
    const double cos = std::cos(angles_.elevation_rad[channel]);
    const double sin = std::sin(angles_.elevation_rad[channel]);
    const std::int64_t aside = step > 0 ? std::llround(angles_.azimuth_rad[channel] / step) : 0;
    for (std::size_t c = 0; c < beams; ++c) {
      const std::int64_t place = ((static_cast<std::int64_t>(c) + aside) % n + n) % n;
      const std::size_t i = ring_[channel] * beams + static_cast<std::size_t>(place);
      const Fired& column = columns_[c];
      const spinning::Return& back = column.returns[channel];
      const double head = column.azimuth_rad + back.turned_rad;
      const double azimuth = head + angles_.azimuth_rad[channel];
      const Eigen::Vector3d direction(cos * std::cos(azimuth), -cos * std::sin(azimuth), sin);
      const Eigen::Vector3d lens(lens_.outward_m * std::cos(head),
                                 -lens_.outward_m * std::sin(head), lens_.up_m);
      cloud.ring[i] = static_cast<std::uint16_t>(ring_[channel]);
      const bool fired = std::isfinite(back.after_us);
      cloud.utime[i] = std::llround(column.utime + (fired ? back.after_us : 0));
      if (!fired) continue;
      cloud.directions[i] = direction.cast<float>();
      cloud.intensity[i] = static_cast<float>(back.reflectivity) / 255;
      if (back.range_m > 0) cloud.points[i] = (lens + back.range_m * direction).cast<float>();
    }
  }
  return cloud;
}

}  // namespace rgbdt
