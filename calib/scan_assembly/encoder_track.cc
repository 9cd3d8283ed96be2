#include "calib/scan_assembly/encoder_track.h"

#include <algorithm>
#include <iterator>

namespace rgbdt {

EncoderReading OnTime(const TurnedScanner& scanner, EncoderReading reading) {
  reading.utime -= FromSeconds(scanner.encoder_delay_s);
  return reading;
}

bool EncoderTrack::Add(const EncoderReading& reading) {
  if (!readings_.empty() && reading.utime <= readings_.back().utime) return false;
  readings_.push_back(reading);
  return true;
}

namespace {

auto FirstAfter(const std::deque<EncoderReading>& readings, Utime utime) {
  return std::upper_bound(readings.begin(), readings.end(), utime,
                          [](Utime t, const EncoderReading& r) { return t < r.utime; });
}

}  // namespace

std::optional<EncoderTrack::Stretch> EncoderTrack::StretchAt(const TurnedScanner& scanner,
                                                             Utime utime, Utime max_gap) const {
  const auto angle = [&](const EncoderReading& r) {
    return (static_cast<double>(r.ticks) - scanner.zero_ticks) / scanner.ticks_per_rad;
  };
  const auto after = FirstAfter(readings_, utime);
  if (after == readings_.begin()) return std::nullopt;
  const EncoderReading& before = *std::prev(after);
  if (after != readings_.end() && after->utime - before.utime <= max_gap) {
    return Stretch{before.utime, after->utime, angle(before), angle(*after) - angle(before)};
  }
  if (before.utime == utime) return Stretch{utime, utime + 1, angle(before), 0};
  return std::nullopt;
}

std::optional<double> EncoderTrack::AngleAt(const TurnedScanner& scanner, Utime utime,
                                            Utime max_gap) const {
  const auto stretch = StretchAt(scanner, utime, max_gap);
  return stretch ? std::optional<double>(stretch->AngleAt(utime)) : std::nullopt;
}

Utime EncoderTrack::SweepAt(Utime utime) const {
  const auto after = FirstAfter(readings_, utime);
  return after == readings_.begin() ? 0 : std::prev(after)->sweep_utime;
}

std::optional<std::vector<double>> BeamAngles(const TurnedScanner& scanner,
                                              const EncoderTrack& track, const LineScan& line,
                                              Utime max_gap) {
  std::vector<double> angles(line.range.size());
  for (std::size_t i = 0; i < angles.size();) {
    Utime fired = line.FiredAt(i);
    const auto stretch = track.StretchAt(scanner, fired, max_gap);
    if (!stretch) return std::nullopt;
    while (stretch->Contains(fired)) {
      angles[i] = stretch->AngleAt(fired);
      if (++i == angles.size()) break;
      fired = line.FiredAt(i);
    }
  }
  return angles;
}

void EncoderTrack::ForgetBefore(Utime utime) {
  while (readings_.size() > 1 && readings_[1].utime <= utime) readings_.pop_front();
}

}  // namespace rgbdt
