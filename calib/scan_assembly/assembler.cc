#include "calib/scan_assembly/assembler.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "calib/model/errors.h"

namespace rgbdt {

Cloud LineToCloud(const TurnedScanner& scanner, const LineScan& line,
                  const std::vector<double>& angles) {
  const std::size_t beams = line.range.size();
  Cloud cloud;
  cloud.lines = 1;
  cloud.beams = static_cast<int>(beams);
  cloud.points.resize(beams);
  cloud.directions.resize(beams);
  cloud.intensity = line.intensity;
  cloud.utime.resize(beams);
  cloud.ring.resize(beams);
  const Eigen::Matrix3d motor_from_scanner = scanner.motor_from_scanner.rotation.toRotationMatrix();
  const Eigen::Vector3d& lever = scanner.motor_from_scanner.translation;
  const Eigen::Vector3f nothing =
      Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
  for (std::size_t i = 0; i < beams; ++i) {
    const double a = line.first_angle_rad + static_cast<double>(i) * line.angle_step_rad;
    const double c = std::cos(angles[i]);
    const double s = std::sin(angles[i]);
    const auto turned = [&](const Eigen::Vector3d& v) {
      return Eigen::Vector3d(c * v.x() - s * v.y(), s * v.x() + c * v.y(), v.z());
    };
    const Eigen::Vector3d direction =
        turned(motor_from_scanner * Eigen::Vector3d(std::cos(a), 0, std::sin(a)));
    const Eigen::Vector3d origin = turned(lever);
    if (i == beams / 2) cloud.origins = {origin.cast<float>()};
    const float range = line.range[i];
    cloud.directions[i] = direction.cast<float>();
    cloud.points[i] = std::isfinite(range)
                          ? Eigen::Vector3f((origin + range * direction).cast<float>())
                          : nothing;
    cloud.utime[i] = line.utime + FromSeconds(static_cast<double>(i) * line.beam_period_s);
    cloud.ring[i] = static_cast<std::uint16_t>(i);
  }
  return cloud;
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

std::optional<double> EncoderTrack::AngleAt(const TurnedScanner& scanner, Utime utime,
                                            Utime max_gap) const {
  const auto angle = [&](const EncoderReading& r) {
    return (static_cast<double>(r.ticks) - scanner.zero_ticks) / scanner.ticks_per_rad;
  };
  const auto after = FirstAfter(readings_, utime);
  if (after == readings_.begin()) return std::nullopt;
  const EncoderReading& before = *std::prev(after);
  if (before.utime == utime) return angle(before);
  if (after == readings_.end() || after->utime - before.utime > max_gap) return std::nullopt;
  const double part =
      static_cast<double>(utime - before.utime) / static_cast<double>(after->utime - before.utime);
  return angle(before) + part * (angle(*after) - angle(before));
}

Utime EncoderTrack::SweepAt(Utime utime) const {
  const auto after = FirstAfter(readings_, utime);
  return after == readings_.begin() ? 0 : std::prev(after)->sweep_utime;
}

std::optional<std::vector<double>> BeamAngles(const TurnedScanner& scanner,
                                              const EncoderTrack& track, const LineScan& line,
                                              Utime max_gap) {
  std::vector<double> angles;
  angles.reserve(line.range.size());
  for (std::size_t i = 0; i < line.range.size(); ++i) {
    const Utime fired = line.utime + FromSeconds(static_cast<double>(i) * line.beam_period_s);
    const auto angle = track.AngleAt(scanner, fired, max_gap);
    if (!angle) return std::nullopt;
    angles.push_back(*angle);
  }
  return angles;
}

void EncoderTrack::ForgetBefore(Utime utime) {
  while (readings_.size() > 1 && readings_[1].utime <= utime) readings_.pop_front();
}

namespace {

template <typename T>
void Append(const std::vector<T>& from, std::vector<T>* to) {
  to->insert(to->end(), from.begin(), from.end());
}

// Lines that never came, before `next`: nothing is known of them, not even their directions.
void AppendLostLines(int count, const Cloud& next, Cloud* sweep) {
  if (count <= 0 || !sweep->organised) return;
  const std::size_t n = static_cast<std::size_t>(count) * static_cast<std::size_t>(sweep->beams);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const Eigen::Vector3f unknown = Eigen::Vector3f::Constant(nan);
  sweep->lines += count;
  sweep->points.insert(sweep->points.end(), n, unknown);
  if (!next.directions.empty()) sweep->directions.insert(sweep->directions.end(), n, unknown);
  if (!next.origins.empty()) {
    sweep->origins.insert(sweep->origins.end(), static_cast<std::size_t>(count), next.origins[0]);
  }
  if (!next.intensity.empty()) sweep->intensity.insert(sweep->intensity.end(), n, nan);
  if (!next.utime.empty()) sweep->utime.insert(sweep->utime.end(), n, next.utime[0]);
  for (std::size_t i = 0; i < n && !next.ring.empty(); ++i) {
    sweep->ring.push_back(next.ring[i % static_cast<std::size_t>(sweep->beams)]);
  }
}

}  // namespace

void RequireJoinable(const Cloud& a, const Cloud& b) {
  // Vectors of a cloud may be empty, but joined to others they would be shorter than `points`.
  if (a.organised != b.organised || a.directions.empty() != b.directions.empty() ||
      a.origins.empty() != b.origins.empty() || a.intensity.empty() != b.intensity.empty() ||
      a.utime.empty() != b.utime.empty() || a.ring.empty() != b.ring.empty()) {
    throw InputError(
        "a sweep's chunks differ in what they tell of their points (directions, origins, "
        "intensity, utime, ring): those of lines " +
        std::to_string(a.first_line) + " and " + std::to_string(b.first_line));
  }
  if (a.organised && a.beams != b.beams) {
    throw InputError("a sweep's chunks have " + std::to_string(a.beams) + " and " +
                     std::to_string(b.beams) + " beams per line");
  }
}

Cloud JoinChunks(const std::vector<CloudChunk>& chunks) {
  std::vector<const Cloud*> parts;
  for (const CloudChunk& chunk : chunks) {
    if (!chunk.cloud.points.empty()) parts.push_back(&chunk.cloud);
  }
  std::stable_sort(parts.begin(), parts.end(),
                   [](const Cloud* a, const Cloud* b) { return a->first_line < b->first_line; });
  Cloud sweep;
  for (const Cloud* part : parts) {
    if (sweep.lines == 0) {
      sweep.sweep_utime = part->sweep_utime;
      sweep.first_line = part->first_line;
      sweep.beams = part->beams;
      sweep.organised = part->organised;
    }
    RequireJoinable(*parts.front(), *part);
    const int place = part->first_line - sweep.first_line;
    if (place < sweep.lines) continue;  // the same lines again
    constexpr std::int64_t kMaxPoints = 100'000'000;
    if (static_cast<std::int64_t>(place + part->lines) * sweep.beams > kMaxPoints) {
      throw InputError("a sweep's chunk begins at line " + std::to_string(part->first_line) +
                       " of " + std::to_string(sweep.beams) + " beams: more than " +
                       std::to_string(kMaxPoints) + " points");
    }
    AppendLostLines(place - sweep.lines, *part, &sweep);
    sweep.lines += part->lines;
    Append(part->points, &sweep.points);
    Append(part->directions, &sweep.directions);
    Append(part->origins, &sweep.origins);
    Append(part->intensity, &sweep.intensity);
    Append(part->utime, &sweep.utime);
    Append(part->ring, &sweep.ring);
  }
  if (!sweep.organised) {
    sweep.lines = 1;
    sweep.beams = static_cast<int>(sweep.points.size());
  }
  return sweep;
}

}  // namespace rgbdt
