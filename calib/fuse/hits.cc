#include "calib/fuse/hits.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "calib/model/slice.h"

namespace rgbdt {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
constexpr float kMost = std::numeric_limits<float>::max();

// Finite: not so for NaN and infinity.
bool IsHit(const Eigen::Vector3f& p) {
  return std::abs(p.x()) + std::abs(p.y()) + std::abs(p.z()) < kMost;
}

// Whether all are, quickly; false also where a coordinate is nearly endless.
bool AreHits(const Eigen::Vector3f* points, std::size_t count) {
  const float* coordinates = points->data();
  unsigned bad = 0;
  for (std::size_t i = 0; i < 3 * count; ++i) {
    bad |= std::abs(coordinates[i]) < kMost / 4 ? 0U : 1U;
  }
  return bad == 0;
}

// Points [first, end); an empty vector stands for as many of `missing`.
template <typename T>
void AppendRange(const std::vector<T>& from, T missing, std::size_t first, std::size_t end,
                 std::vector<T>* to) {
  if (from.empty()) {
    to->resize(to->size() + end - first, missing);
  } else {
    to->insert(to->end(), from.data() + first, from.data() + end);
  }
}

// Of what was added last, points [first, end), those that are hits.
template <typename T>
void KeepHits(const Cloud& chunk, std::size_t first, std::size_t end, std::vector<T>* added) {
  std::size_t count = added->size() - (end - first);
  const std::size_t shift = count - first;
  for (std::size_t i = first; i < end; ++i) {
    (*added)[count] = (*added)[i + shift];
    count += IsHit(chunk.points[i]) ? 1 : 0;
  }
  added->resize(count);
}

}  // namespace

void Hits::Append(const Hits& more) {
  const auto append = [](const auto& from, auto* to) {
    to->insert(to->end(), from.begin(), from.end());
  };
  append(more.points, &points);
  append(more.intensity, &intensity);
  append(more.utime, &utime);
}

Hits Hits::Part(std::size_t first, std::size_t end) const {
  return {Slice(points, first, end), Slice(intensity, first, end), Slice(utime, first, end)};
}

void Hits::Clear() {
  points.clear();
  intensity.clear();
  utime.clear();
}

Hits HitsOf(const Cloud& chunk) {
  Hits hits;
  hits.points.reserve(chunk.size());
  hits.intensity.reserve(chunk.size());
  hits.utime.reserve(chunk.size());
  constexpr std::size_t kTile = 512;
  for (std::size_t first = 0; first < chunk.size(); first += kTile) {
    const std::size_t end = std::min(first + kTile, chunk.size());
    AppendRange(chunk.points, Eigen::Vector3f(kNone, kNone, kNone), first, end, &hits.points);
    AppendRange(chunk.intensity, kNone, first, end, &hits.intensity);
    AppendRange(chunk.utime, chunk.sweep_utime, first, end, &hits.utime);
    if (AreHits(&chunk.points[first], end - first)) continue;
    KeepHits(chunk, first, end, &hits.points);
    KeepHits(chunk, first, end, &hits.intensity);
    KeepHits(chunk, first, end, &hits.utime);
  }
  return hits;
}

}  // namespace rgbdt
