#include "calib/scan_assembly/sweep_chunks.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <string>

#include "calib/model/errors.h"
#include "calib/model/slice.h"

namespace rgbdt {
namespace {

constexpr std::size_t kMaxChunkBytes = 1024 * 1024;
// A point's place, intensity, time and ring; of a miss also its index and direction.
constexpr std::size_t kPointBytes = 22 + 16;

Cloud Lines(const Cloud& sweep, int first, int count) {
  const auto beams = static_cast<std::size_t>(sweep.beams);
  const std::size_t from = static_cast<std::size_t>(first) * beams;
  const std::size_t end = from + static_cast<std::size_t>(count) * beams;
  Cloud part;
  part.sweep_utime = sweep.sweep_utime;
  part.first_line = sweep.first_line + first;
  part.lines = count;
  part.beams = sweep.beams;
  part.organised = sweep.organised;
  part.points = Slice(sweep.points, from, end);
  part.directions = Slice(sweep.directions, from, end);
  part.origins = Slice(sweep.origins, static_cast<std::size_t>(first),
                       static_cast<std::size_t>(first + count));
  part.intensity = Slice(sweep.intensity, from, end);
  part.utime = Slice(sweep.utime, from, end);
  part.ring = Slice(sweep.ring, from, end);
  return part;
}

template <typename T>
void Fill(std::vector<T>* values, std::size_t size, const T& value) {
  if (!values->empty()) values->resize(size, value);
}

// One line of points as several.
Cloud InLines(const Cloud& sweep, int lines) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const Eigen::Vector3f nothing(kNan, kNan, kNan);
  Cloud cut = sweep;
  cut.lines = lines;
  cut.beams = (static_cast<int>(sweep.size()) + lines - 1) / lines;
  const auto size = static_cast<std::size_t>(cut.lines) * static_cast<std::size_t>(cut.beams);
  Fill(&cut.points, size, nothing);
  Fill(&cut.directions, size, nothing);
  Fill(&cut.intensity, size, kNan);
  Fill(&cut.utime, size, sweep.utime.empty() ? Utime{0} : sweep.utime.back());
  Fill(&cut.ring, size, std::uint16_t{0xffff});
  if (!sweep.origins.empty()) {
    cut.origins.assign(static_cast<std::size_t>(lines), sweep.origins.front());
  }
  return cut;
}

int LinesPerChunk(const Cloud& sweep) {
  const std::size_t line_bytes = kPointBytes * static_cast<std::size_t>(std::max(1, sweep.beams));
  return static_cast<int>(std::max<std::size_t>(1, kMaxChunkBytes / line_bytes));
}

}  // namespace

std::vector<CloudChunk> SplitSweep(const Cloud& sweep) {
  if (!sweep.organised && sweep.lines == 1) {
    const std::size_t bytes = kPointBytes * sweep.size();
    const auto lines = static_cast<int>(bytes / kMaxChunkBytes) + 1;
    if (lines > 1) return SplitSweep(InLines(sweep, lines));
  }
  const int step = sweep.organised ? LinesPerChunk(sweep) : 1;
  std::vector<CloudChunk> chunks;
  for (int first = 0; first < sweep.lines; first += step) {
    CloudChunk chunk;
    chunk.cloud = Lines(sweep, first, std::min(step, sweep.lines - first));
    chunks.push_back(std::move(chunk));
  }
  if (chunks.empty()) {
    chunks.emplace_back();
    chunks.back().cloud.sweep_utime = sweep.sweep_utime;
  }
  chunks.back().sweep_end = true;
  chunks.back().sweep_lines = sweep.lines;
  return chunks;
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
