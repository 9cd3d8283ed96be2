#include "calib/detect/cloud/internal/ring_rows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numeric>

#include "calib/model/statistics.h"

namespace rgbdt {
namespace {

using Angles = RangeGrid::Angles;
using Rows = RangeGrid::Rows;

Rows ByRing(const Cloud& cloud, const std::vector<Angles>& angles) {
  Rows by_ring(65536);
  for (const Angles& a : angles) {
    by_ring[cloud.ring[static_cast<std::size_t>(a.point)]].push_back(a);
  }
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t ring = 0; ring < by_ring.size(); ++ring) {
    if (!by_ring[ring].empty()) order.emplace_back(MedianElevation(by_ring[ring]), ring);
  }
  std::sort(order.begin(), order.end());
  Rows rows;
  for (const auto& [elevation, ring] : order) rows.push_back(std::move(by_ring[ring]));
  return rows;
}

// The elevations that the points keep to; nothing where they keep to none, as those of a turned
// scanner do not.
std::optional<Rows> ByElevation(const std::vector<Angles>& angles) {
  constexpr double kBin = 0.02 * M_PI / 180;
  const auto bin_of = [&](const Angles& a) {
    return static_cast<std::size_t>((a.elevation + M_PI / 2) / kBin);
  };
  std::vector<int> counts(static_cast<std::size_t>(M_PI / kBin) + 2, 0);
  for (const Angles& a : angles) ++counts[bin_of(a)];
  // Runs of occupied bins; a stray point or two is no ring.
  const int least = std::max<int>(2, static_cast<int>(angles.size() / 20000));
  std::vector<int> row_of(counts.size(), -1);
  int rows = 0;
  int occupied = 0;
  std::size_t first = 0;
  std::size_t last = 0;
  for (std::size_t b = 0; b < counts.size(); ++b) {
    if (counts[b] < least) continue;
    if (rows == 0) first = b;
    if (rows == 0 || b > last + 2) ++rows;
    last = b;
    ++occupied;
    row_of[b] = rows - 1;
  }
  if (rows < 4 || rows > 300 || occupied * 2 > static_cast<int>(last - first)) return std::nullopt;
  Rows out(static_cast<std::size_t>(rows));
  for (const Angles& a : angles) {
    const int row = row_of[bin_of(a)];
    if (row >= 0) out[static_cast<std::size_t>(row)].push_back(a);
  }
  return out;
}

// Whether points of one number keep to one elevation, as far as those of one direction do: a LIDAR
// may be tilted, and where its beams do not meet in a point their elevations differ with range. A
// number that tells the ring leaves little of the cloud's own spread; a quarter of its square is
// the most.
bool KeepToElevations(const Rows& rows) {
  constexpr double kSector = 3 * M_PI / 180;
  struct Sums {
    double count = 0, sum = 0, squares = 0;
    void Add(const Sums& s) { count += s.count, sum += s.sum, squares += s.squares; }
    double Spread() const { return count > 0 ? squares - sum * sum / count : 0; }
  };
  double within = 0;
  Sums all;
  for (const auto& row : rows) {
    std::array<Sums, 121> sectors{};
    for (const Angles& a : row) {
      const double e = a.elevation;
      sectors[static_cast<std::size_t>((a.azimuth + M_PI) / kSector)].Add({1, e, e * e});
    }
    for (const Sums& sector : sectors) {
      within += sector.Spread();
      all.Add(sector);
    }
  }
  return within < 0.25 * all.Spread();
}

// Marks what a row has of further turns. The row is in the cloud's order: as it was measured, or
// nothing is marked.
void MarkFurtherTurns(std::vector<Angles>* row) {
  constexpr double kBack = 0.05;  // firings out of order, at most [rad]
  const auto step = [&](std::size_t i) {
    return std::remainder(double{(*row)[i].azimuth} - (*row)[i - 1].azimuth, 2 * M_PI);
  };
  std::size_t left = 0;
  std::size_t right = 0;
  for (std::size_t i = 1; i < row->size(); ++i) {
    left += step(i) > 1e-6 ? 1 : 0;
    right += step(i) < -1e-6 ? 1 : 0;
  }
  if (10 * std::max(left, right) < 7 * (left + right)) return;
  const double sense = left > right ? 1 : -1;
  double turned = 0;
  for (std::size_t i = 1; i < row->size(); ++i) {
    const double by = sense * step(i);
    turned += by < -kBack ? by + 2 * M_PI : by;
    (*row)[i].again = turned > 2 * M_PI - 1e-4;
  }
}

void SortByAzimuth(std::vector<Angles>* row) {
  std::sort(row->begin(), row->end(),
            [](const Angles& a, const Angles& b) { return a.azimuth < b.azimuth; });
}

// From each beam of the first turn to the next one [rad]; rows by azimuth.
std::vector<float> StepsOfOneTurn(const Rows& rows) {
  std::vector<float> steps;
  for (const auto& row : rows) {
    const Angles* last = nullptr;
    for (const Angles& a : row) {
      if (a.again || steps.size() >= 200000) continue;
      if (last != nullptr) steps.push_back(a.azimuth - last->azimuth);
      last = &a;
    }
  }
  return steps;
}

struct BeamSteps {
  double step = 0;  // from beam to beam [rad]
  double same = 0;  // points closer than that are of one beam
};

// Points of one beam lie clearly closer than those of two; where there are some between, as where
// points were taken out at random, nothing is one beam.
BeamSteps MeasureBeams(const Rows& rows) {
  constexpr float kFinest = 2e-4F;
  const std::vector<float> steps = StepsOfOneTurn(rows);
  std::vector<float> apart;
  std::copy_if(steps.begin(), steps.end(), std::back_inserter(apart),
               [](float s) { return s > kFinest; });
  BeamSteps out;
  out.step = Median(std::move(apart));
  out.same = 0.2 * out.step;
  const auto closer = [&](double than) {
    return std::count_if(steps.begin(), steps.end(), [&](float s) { return s < than; });
  };
  if (closer(3 * out.same) > 2 * closer(out.same)) out.same = 0;
  return out;
}

// Leaves one return of each beam of a row that is sorted by azimuth.
void TakeOneOfEachBeam(const Cloud& cloud, const BeamSteps& steps, std::vector<Angles>* row) {
  const bool bright = cloud.intensity.size() == cloud.size();
  const auto is_better = [&](const Angles& a, const Angles& b) {
    const float of_a = bright ? cloud.intensity[static_cast<std::size_t>(a.point)] : 0;
    const float of_b = bright ? cloud.intensity[static_cast<std::size_t>(b.point)] : 0;
    return of_a > of_b || (!(of_b > of_a) && a.point < b.point);
  };
  std::vector<Angles> beams;
  for (std::size_t i = 0; i < row->size();) {
    Angles best = (*row)[i];
    bool again = best.again;
    std::size_t next = i + 1;
    for (; next < row->size() && (*row)[next].azimuth - (*row)[i].azimuth <= steps.same; ++next) {
      again &= (*row)[next].again;
      if (is_better((*row)[next], best)) best = (*row)[next];
    }
    best.again = again;
    beams.push_back(best);
    i = next;
  }
  // Of further turns what lies between beams of the first one tells nothing new.
  row->clear();
  const auto near_first = [&](std::size_t i, std::ptrdiff_t way) {
    const auto size = static_cast<std::ptrdiff_t>(beams.size());
    for (auto k = static_cast<std::ptrdiff_t>(i) + way; k >= 0 && k < size; k += way) {
      const Angles& other = beams[static_cast<std::size_t>(k)];
      if (std::abs(other.azimuth - beams[i].azimuth) > 0.9 * steps.step) return false;
      if (!other.again) return true;
    }
    return false;
  };
  for (std::size_t i = 0; i < beams.size(); ++i) {
    if (!beams[i].again || !(near_first(i, -1) || near_first(i, 1))) row->push_back(beams[i]);
  }
}

// Pairs of points in one cell of so many radians.
double PairsInCells(const std::vector<Angles>& angles, double width, double height) {
  std::vector<std::pair<int, int>> cells;
  cells.reserve(angles.size());
  for (const Angles& a : angles) {
    cells.emplace_back(static_cast<int>(std::floor(a.elevation / height)),
                       static_cast<int>(std::floor(a.azimuth / width)));
  }
  std::sort(cells.begin(), cells.end());
  double pairs = 0;
  std::size_t first = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (cells[i] != cells[first]) first = i;
    pairs += static_cast<double>(i - first);
  }
  return pairs;
}

std::size_t CountOf(const Rows& rows) {
  return std::accumulate(rows.begin(), rows.end(), std::size_t{0},
                         [](std::size_t sum, const auto& row) { return sum + row.size(); });
}

// The part of the points that would be too many, were each ring there several times, each time at
// azimuths of its own: then only the next but one, or the next but two, ... is a step away. Rows by
// azimuth.
double SharedBeams(const Rows& rows) {
  constexpr std::size_t kMostTimes = 8;
  constexpr double kAlike = 0.1, kRegular = 0.6, kClearly = 0.75;
  for (std::size_t k = 1; k <= kMostTimes; ++k) {
    std::vector<float> steps;
    for (const auto& row : rows) {
      for (std::size_t i = k; i < row.size() && steps.size() < 200000; ++i) {
        steps.push_back(row[i].azimuth - row[i - k].azimuth);
      }
    }
    const float step = Median(steps);
    const auto alike = std::count_if(steps.begin(), steps.end(),
                                     [&](float s) { return std::abs(s - step) < kAlike * step; });
    const double part = static_cast<double>(alike) / static_cast<double>(steps.size() + 1);
    if (k == 1 && part > kRegular) return 0;
    if (k > 1 && part > kClearly) return 1 - 1.0 / static_cast<double>(k);
  }
  return 0;
}

}  // namespace

std::vector<Angles> AnglesOf(const Cloud& cloud) {
  std::vector<Angles> angles;
  angles.reserve(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Eigen::Vector3f& p = cloud.points[i];
    const float flat = p.x() * p.x() + p.y() * p.y();
    if (!p.allFinite() || !(flat + p.z() * p.z() > 1e-6F)) continue;
    angles.push_back({std::atan2(p.y(), p.x()), std::atan2(p.z(), std::sqrt(flat)),
                      static_cast<std::int32_t>(i)});
  }
  return angles;
}

bool LieInRows(const std::vector<Angles>& angles) {
  constexpr double kLong = M_PI / 180, kShort = 0.1 * kLong, kClearly = 4;
  return PairsInCells(angles, kLong, kShort) > kClearly * PairsInCells(angles, kShort, kLong);
}

double MedianElevation(const std::vector<Angles>& row) {
  std::vector<double> elevations;
  const std::size_t step = std::max<std::size_t>(1, row.size() / 500);
  for (std::size_t i = 0; i < row.size(); i += step) elevations.push_back(row[i].elevation);
  return Median(std::move(elevations));
}

std::optional<RingRows> FindRingRows(const Cloud& cloud, const std::vector<Angles>& angles) {
  RingRows out;
  const bool numbered = cloud.ring.size() == cloud.size();
  if (numbered) out.rows = ByRing(cloud, angles);
  if (out.rows.size() > kMostRings) return std::nullopt;
  if (!numbered || !KeepToElevations(out.rows)) {
    auto found = ByElevation(angles);
    if (!found || found->size() > kMostRings) return std::nullopt;
    out = {std::move(*found), numbered};
  }
  if (out.rows.size() < 2) return std::nullopt;
  for (auto& row : out.rows) {
    MarkFurtherTurns(&row);
    SortByAzimuth(&row);
  }
  const BeamSteps steps = MeasureBeams(out.rows);
  Rows beams = out.rows;
  for (auto& row : beams) TakeOneOfEachBeam(cloud, steps, &row);
  if (50 * (CountOf(out.rows) - CountOf(beams)) > CountOf(out.rows)) out.rows = std::move(beams);
  out.shared = SharedBeams(out.rows);
  return out;
}

}  // namespace rgbdt
