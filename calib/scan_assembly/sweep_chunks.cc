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
  part.first_line = first;
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

// Lines that never came, beside those of `neighbour`, the first of which, or the last, is nearest:
// nothing is known of them, not even their directions.
void AppendLostLines(int count, const Cloud& neighbour, bool nearest_is_last, Cloud* sweep) {
  if (count <= 0 || !sweep->organised) return;
  const std::size_t n = static_cast<std::size_t>(count) * static_cast<std::size_t>(sweep->beams);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const Eigen::Vector3f unknown = Eigen::Vector3f::Constant(nan);
  const auto nearest = [&](const auto& values) {
    return nearest_is_last ? values.back() : values.front();
  };
  const auto fill = [](std::size_t size, const auto& value, auto* values) {
    values->insert(values->end(), size, value);
  };
  sweep->lines += count;
  fill(n, unknown, &sweep->points);
  if (!neighbour.directions.empty()) fill(n, unknown, &sweep->directions);
  if (!neighbour.origins.empty()) {
    fill(static_cast<std::size_t>(count), nearest(neighbour.origins), &sweep->origins);
  }
  if (!neighbour.intensity.empty()) fill(n, nan, &sweep->intensity);
  if (!neighbour.utime.empty()) fill(n, nearest(neighbour.utime), &sweep->utime);
  for (std::size_t i = 0; i < n && !neighbour.ring.empty(); ++i) {
    sweep->ring.push_back(neighbour.ring[i % static_cast<std::size_t>(sweep->beams)]);
  }
}

// The parts that hold lines, in the order of their lines.
std::vector<const Cloud*> PartsOf(const std::vector<CloudChunk>& chunks) {
  std::vector<const Cloud*> parts;
  for (const CloudChunk& chunk : chunks) {
    if (!chunk.cloud.points.empty()) parts.push_back(&chunk.cloud);
  }
  std::stable_sort(parts.begin(), parts.end(),
                   [](const Cloud* a, const Cloud* b) { return a->first_line < b->first_line; });
  return parts;
}

// As the chunk that ends the sweep tells; 0: it does not.
int LinesTold(const std::vector<CloudChunk>& chunks) {
  int lines = 0;
  for (const CloudChunk& chunk : chunks) lines = std::max(lines, chunk.sweep_lines);
  return lines;
}

// Of an unorganised sweep lines that never came take no memory.
void RequireBounded(std::int64_t lines, const Cloud& sweep) {
  constexpr std::int64_t kMaxPoints = 100'000'000;
  if (!sweep.organised || lines * sweep.beams <= kMaxPoints) return;
  throw InputError("a sweep reaches to line " + std::to_string(lines) + " of " +
                   std::to_string(sweep.beams) + " beams: more than " + std::to_string(kMaxPoints) +
                   " points");
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
  const std::vector<const Cloud*> parts = PartsOf(chunks);
  Cloud sweep;
  if (parts.empty()) return sweep;
  sweep.sweep_utime = parts.front()->sweep_utime;
  sweep.beams = parts.front()->beams;
  sweep.organised = parts.front()->organised;
  int reach = 0;
  for (const Cloud* part : parts) {
    RequireJoinable(*parts.front(), *part);
    if (part->first_line < reach) continue;  // the same lines again
    RequireBounded(std::int64_t{part->first_line} + part->lines, sweep);
    AppendLostLines(part->first_line - reach, *part, false, &sweep);
    reach = part->first_line + part->lines;
    sweep.lines += part->lines;
    Append(part->points, &sweep.points);
    Append(part->directions, &sweep.directions);
    Append(part->origins, &sweep.origins);
    Append(part->intensity, &sweep.intensity);
    Append(part->utime, &sweep.utime);
    Append(part->ring, &sweep.ring);
  }
  const int lines = LinesTold(chunks);
  RequireBounded(lines, sweep);
  AppendLostLines(lines - reach, *parts.back(), true, &sweep);
  if (!sweep.organised) {
    sweep.lines = 1;
    sweep.beams = static_cast<int>(sweep.points.size());
    if (!sweep.origins.empty()) sweep.origins.resize(1);
  }
  return sweep;
}

int MissingLines(const std::vector<CloudChunk>& chunks) {
  int missing = 0;
  int reach = 0;
  for (const Cloud* part : PartsOf(chunks)) {
    if (part->first_line < reach) continue;  // as where they are joined
    missing += part->first_line - reach;
    reach = part->first_line + part->lines;
  }
  return missing + std::max(0, LinesTold(chunks) - reach);
}

}  // namespace rgbdt
