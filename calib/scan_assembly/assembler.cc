#include "calib/scan_assembly/assembler.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>

#include "calib/model/errors.h"

namespace rgbdt {

namespace {

// Beams are taken in blocks: a sine and a cosine of each block's first beam and middle motor angle
// give those of the others, and the arithmetic on them has no branches.
constexpr std::size_t kBlock = 16;
template <typename T>
using Block = std::array<T, kBlock>;

struct Turns {
  Block<double> cos, sin;
};

// Directions in the scan plane, evenly spaced.
class ScanPlane {
 public:
  explicit ScanPlane(const LineScan& line)
      : first_rad_(line.first_angle_rad), step_rad_(line.angle_step_rad) {
    for (std::size_t i = 0; i < kBlock; ++i) {
      const double a = static_cast<double>(i) * step_rad_;
      steps_.cos[i] = std::cos(a);
      steps_.sin[i] = std::sin(a);
    }
  }

  // Of the block that begins with beam `first`.
  Turns At(std::size_t first) const {
    const double a = first_rad_ + static_cast<double>(first) * step_rad_;
    const double c = std::cos(a);
    const double s = std::sin(a);
    Turns turns;
    for (std::size_t i = 0; i < kBlock; ++i) {
      turns.cos[i] = c * steps_.cos[i] - s * steps_.sin[i];
      turns.sin[i] = s * steps_.cos[i] + c * steps_.sin[i];
    }
    return turns;
  }

 private:
  double first_rad_, step_rad_;
  Turns steps_;
};

// Of angles that lie close together, as a motor's do during a block; of any others, too.
Turns TurnsOf(const Block<double>& angles) {
  constexpr double kClose = 0.02;  // [rad]; beyond, the series below are wrong by more than 1e-13
  const double middle = angles[kBlock / 2];
  double farthest = 0;
  for (const double angle : angles) farthest = std::max(farthest, std::abs(angle - middle));
  Turns turns;
  if (!(farthest <= kClose)) {
    for (std::size_t i = 0; i < kBlock; ++i) {
      turns.cos[i] = std::cos(angles[i]);
      turns.sin[i] = std::sin(angles[i]);
    }
    return turns;
  }
  const double c = std::cos(middle);
  const double s = std::sin(middle);
  for (std::size_t i = 0; i < kBlock; ++i) {
    const double d = angles[i] - middle;
    const double dd = d * d;
    const double small_sin = d * (1 - dd * (1.0 / 6 - dd * (1.0 / 120)));
    const double small_cos = 1 - dd * (0.5 - dd * (1.0 / 24));
    turns.cos[i] = c * small_cos - s * small_sin;
    turns.sin[i] = s * small_cos + c * small_sin;
  }
  return turns;
}

struct BlockOfBeams {
  Block<float> x, y, z;     // point
  Block<float> dx, dy, dz;  // direction
};

// Where the scan plane lies in the motor's frame.
struct Mount {
  explicit Mount(const Rigid3& motor_from_scanner)
      : ahead(motor_from_scanner.rotation * Eigen::Vector3d::UnitX()),
        up(motor_from_scanner.rotation * Eigen::Vector3d::UnitZ()),
        lever(motor_from_scanner.translation) {}

  Eigen::Vector3d ahead, up, lever;
};

// Point and direction of each beam of a block; a point is NaN where the range is no number.
BlockOfBeams BeamsOf(const Mount& mount, const Turns& beam, const Turns& motor,
                     const Block<float>& range) {
  const auto& [ahead, up, lever] = mount;
  BlockOfBeams out;
  for (std::size_t i = 0; i < kBlock; ++i) {
    const double x = ahead.x() * beam.cos[i] + up.x() * beam.sin[i];
    const double y = ahead.y() * beam.cos[i] + up.y() * beam.sin[i];
    const double z = ahead.z() * beam.cos[i] + up.z() * beam.sin[i];
    const double dx = motor.cos[i] * x - motor.sin[i] * y;
    const double dy = motor.sin[i] * x + motor.cos[i] * y;
    const double r = static_cast<double>(range[i]);
    out.dx[i] = static_cast<float>(dx);
    out.dy[i] = static_cast<float>(dy);
    out.dz[i] = static_cast<float>(z);
    out.x[i] = static_cast<float>(motor.cos[i] * lever.x() - motor.sin[i] * lever.y() + r * dx);
    out.y[i] = static_cast<float>(motor.sin[i] * lever.x() + motor.cos[i] * lever.y() + r * dy);
    out.z[i] = static_cast<float>(lever.z() + r * z);
  }
  return out;
}

// What a block's beams tell, a last block filled up with its last beam.
template <typename T>
Block<T> BlockAt(const std::vector<T>& values, std::size_t first) {
  Block<T> block;
  const std::size_t count = std::min(kBlock, values.size() - first);
  std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(first), count, block.begin());
  std::fill(block.begin() + count, block.end(), values.back());
  return block;
}

Block<float> RangesAt(const LineScan& line, std::size_t first) {
  Block<float> ranges = BlockAt(line.range, first);
  for (float& range : ranges) {
    const bool hit = std::abs(range) <= std::numeric_limits<float>::max();
    range = hit ? range : std::numeric_limits<float>::quiet_NaN();
  }
  return ranges;
}

// When a beam was fired.
Utime FiredAt(const LineScan& line, std::size_t beam) {
  return line.utime + FromSeconds(static_cast<double>(beam) * line.beam_period_s);
}

}  // namespace

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
  if (beams > 0) {
    const Eigen::AngleAxisd turn(angles[beams / 2], Eigen::Vector3d::UnitZ());
    cloud.origins = {(turn * scanner.motor_from_scanner.translation).cast<float>()};
  }
  const Mount mount(scanner.motor_from_scanner);
  const ScanPlane plane(line);
  for (std::size_t first = 0; first < beams; first += kBlock) {
    const BlockOfBeams block =
        BeamsOf(mount, plane.At(first), TurnsOf(BlockAt(angles, first)), RangesAt(line, first));
    const std::size_t count = std::min(kBlock, beams - first);
    for (std::size_t i = 0; i < count; ++i) {
      cloud.points[first + i] = {block.x[i], block.y[i], block.z[i]};
      cloud.directions[first + i] = {block.dx[i], block.dy[i], block.dz[i]};
    }
  }
  for (std::size_t i = 0; i < beams; ++i) cloud.utime[i] = FiredAt(line, i);
  std::iota(cloud.ring.begin(), cloud.ring.end(), std::uint16_t{0});
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
    Utime fired = FiredAt(line, i);
    const auto stretch = track.StretchAt(scanner, fired, max_gap);
    if (!stretch) return std::nullopt;
    while (stretch->Contains(fired)) {
      angles[i] = stretch->AngleAt(fired);
      if (++i == angles.size()) break;
      fired = FiredAt(line, i);
    }
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
