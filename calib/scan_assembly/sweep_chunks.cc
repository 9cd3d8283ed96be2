#include "calib/scan_assembly/sweep_chunks.h"

#include <algorithm>
#include <limits>

namespace rgbdt {
namespace {

constexpr std::size_t kMaxChunkBytes = 1024 * 1024;
// A point's place, intensity, time and ring; of a miss also its index and direction.
constexpr std::size_t kPointBytes = 22 + 16;

template <typename T>
std::vector<T> Part(const std::vector<T>& all, std::size_t first, std::size_t count) {
  if (all.empty()) return {};
  const auto begin = all.begin() + static_cast<std::ptrdiff_t>(first);
  return std::vector<T>(begin, begin + static_cast<std::ptrdiff_t>(count));
}

Cloud Lines(const Cloud& sweep, int first, int count) {
  const auto beams = static_cast<std::size_t>(sweep.beams);
  const std::size_t from = static_cast<std::size_t>(first) * beams;
  const std::size_t size = static_cast<std::size_t>(count) * beams;
  Cloud part;
  part.sweep_utime = sweep.sweep_utime;
  part.first_line = sweep.first_line + first;
  part.lines = count;
  part.beams = sweep.beams;
  part.organised = sweep.organised;
  part.points = Part(sweep.points, from, size);
  part.directions = Part(sweep.directions, from, size);
  part.origins =
      Part(sweep.origins, static_cast<std::size_t>(first), static_cast<std::size_t>(count));
  part.intensity = Part(sweep.intensity, from, size);
  part.utime = Part(sweep.utime, from, size);
  part.ring = Part(sweep.ring, from, size);
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

}  // namespace rgbdt
