#include "calib/odometry/internal/plane_map.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "calib/model/hash.h"
#include "calib/model/linear_algebra.h"

namespace rgbdt::odometry {
namespace {

constexpr int kBits = 21;  // an axis
constexpr std::int64_t kReach = std::int64_t{1} << (kBits - 1);
constexpr std::uint64_t kMask = (std::uint64_t{1} << kBits) - 1;
constexpr std::size_t kFirstSlots = 1024;

using Place = std::array<std::int64_t, 3>;

std::uint64_t KeyOf(const Place& place) {
  std::uint64_t key = 0;
  for (const std::int64_t i : place) key = key << kBits | static_cast<std::uint64_t>(i + kReach);
  return key;
}

Place PlaceOf(std::uint64_t key) {
  const auto axis = [key](int shift) {
    return static_cast<std::int64_t>((key >> shift) & kMask) - kReach;
  };
  return {axis(2 * kBits), axis(kBits), axis(0)};
}

// The finest voxel about a point; nothing beyond what a key holds.
std::optional<Place> FinestPlace(const Eigen::Vector3d& point) {
  Place place;
  for (int axis = 0; axis < 3; ++axis) {
    const double i = std::floor(point[axis] / PlaneMap::kFinest);
    if (!(std::abs(i) < static_cast<double>(kReach))) return std::nullopt;
    place[static_cast<std::size_t>(axis)] = static_cast<std::int64_t>(i);
  }
  return place;
}

Place Coarser(const Place& place, int levels) {
  return {place[0] >> levels, place[1] >> levels, place[2] >> levels};
}

Eigen::Vector3d MiddleOf(const Place& place, double side) {
  return side * (Eigen::Vector3d(static_cast<double>(place[0]), static_cast<double>(place[1]),
                                 static_cast<double>(place[2])) +
                 Eigen::Vector3d::Constant(0.5));
}

}  // namespace

void Moments::Add(const Eigen::Vector3d& p) {
  count += 1;
  sum += p;
  outer[0] += p.x() * p.x();
  outer[1] += p.x() * p.y();
  outer[2] += p.x() * p.z();
  outer[3] += p.y() * p.y();
  outer[4] += p.y() * p.z();
  outer[5] += p.z() * p.z();
}

// sum (p + s)(p + s)^T = sum p p^T + sum s^T + s sum^T + n s s^T
Moments Moments::Shifted(const Eigen::Vector3d& s) const {
  Moments shifted = *this;
  shifted.sum += count * s;
  std::size_t k = 0;
  for (int i = 0; i < 3; ++i) {
    for (int j = i; j < 3; ++j, ++k) {
      shifted.outer[k] += sum[i] * s[j] + s[i] * sum[j] + count * s[i] * s[j];
    }
  }
  return shifted;
}

Moments& Moments::operator+=(const Moments& other) {
  count += other.count;
  sum += other.sum;
  for (std::size_t k = 0; k < outer.size(); ++k) outer[k] += other.outer[k];
  beams += other.beams;
  lines |= other.lines;
  return *this;
}

Eigen::Matrix3d Moments::Covariance() const {
  Eigen::Matrix3d second;
  second << outer[0], outer[1], outer[2], outer[1], outer[3], outer[4], outer[2], outer[4],
      outer[5];
  const Eigen::Vector3d mean = sum / count;
  return second / count - mean * mean.transpose();
}

Plane PlaneOf(const Moments& moments, const Eigen::Vector3d& middle, double side,
              double range_sigma_m) {
  constexpr double kFewest = 8;
  constexpr double kNoise = 0.005;       // [m] no sensor's points lie flatter
  constexpr double kThickest = 0.08;     // [m] 1 sigma across
  constexpr double kFlat = 0.12;         // of the side
  constexpr double kWidest = 9;          // variance along over across: fewer tell a line, no plane
  constexpr double kNormalSigma = 0.05;  // [rad]
  constexpr double kCommon = 0.002;      // [m] a sweep's points, a ring's, are off together
  constexpr double kNoiseKnown = 0.5;    // of the ranges' variance: how well it is known
  Plane plane;
  if (moments.count < kFewest) return plane;
  const Eigen::Vector3d beam = moments.beams / moments.count;
  const double range_variance = range_sigma_m * range_sigma_m;
  const Eigensystem<3> axes = EigensystemOf<3>(
      Eigen::Matrix3d(moments.Covariance() - range_variance * beam * beam.transpose()));
  const double across = std::max(axes.values[0], kNoise * kNoise);
  plane.mean = middle + moments.sum / moments.count;
  plane.normal = axes.vectors.col(0);
  plane.variance = across;
  plane.mean_variance = across / moments.count + kCommon * kCommon;
  const double thickness = std::min(kThickest, kFlat * side);
  if (across > thickness * thickness || axes.values[1] < kWidest * across) return plane;
  double most = 0;
  for (int i = 1; i < 3; ++i) {
    const Eigen::Vector3d along = axes.vectors.col(i);
    const double spread = axes.values[i] - across;
    const double leaning =
        kNoiseKnown * range_variance * beam.dot(along) * beam.dot(plane.normal) / spread;
    const double variance = across * axes.values[i] / (moments.count * spread * spread) +
                            leaning * leaning + kCommon * kCommon / spread;
    most = std::max(most, variance);
    plane.normal_covariance += variance * along * along.transpose();
  }
  const bool lines = (moments.lines & (moments.lines - 1)) != 0;  // two or more
  plane.reliable = lines && most < kNormalSigma * kNormalSigma;
  return plane;
}

VoxelTable::VoxelTable() : slots_(kFirstSlots) {}

std::size_t VoxelTable::SlotOf(std::uint64_t key) const {
  std::size_t slot = Hash(key) & (slots_.size() - 1);
  while (slots_[slot].entry != kNone && slots_[slot].key != key) {
    slot = (slot + 1) & (slots_.size() - 1);
  }
  return slot;
}

std::uint32_t VoxelTable::Find(std::uint64_t key) const { return slots_[SlotOf(key)].entry; }

std::uint32_t VoxelTable::FindOrMake(std::uint64_t key) {
  std::size_t slot = SlotOf(key);
  if (slots_[slot].entry == kNone) {
    if (2 * (entries_.size() + 1) > slots_.size()) {
      Index(2 * slots_.size());
      slot = SlotOf(key);
    }
    slots_[slot] = {key, static_cast<std::uint32_t>(entries_.size())};
    entries_.push_back({key, {}});
  }
  return slots_[slot].entry;
}

void VoxelTable::Clear() {
  entries_.clear();
  std::fill(slots_.begin(), slots_.end(), Slot());
}

void VoxelTable::Index(std::size_t slots) {
  slots_.assign(slots, Slot());
  for (std::uint32_t entry = 0; entry < entries_.size(); ++entry) {
    slots_[SlotOf(entries_[entry].key)] = {entries_[entry].key, entry};
  }
}

void PlaneMap::Add(const std::vector<MapPoint>& points, const Eigen::Vector3d& eye) {
  constexpr double kStation = 0.5;  // [m]
  if ((eye - station_eye_).norm() > kStation) {
    ++station_;
    station_eye_ = eye;
  }
  sweep_.Clear();
  for (const MapPoint& point : points) {
    const std::optional<Place> place = FinestPlace(point.place);
    if (!place) continue;
    Moments& moments = sweep_[sweep_.FindOrMake(KeyOf(*place))].moments;
    moments.Add(point.place - MiddleOf(*place, kFinest));
    moments.lines |= std::uint64_t{1} << ((point.elevation + 11 * station_) & 63);
  }
  for (std::uint32_t i = 0; i < sweep_.size(); ++i) {
    VoxelTable::Entry& cell = sweep_[i];
    const Place finest = PlaceOf(cell.key);
    const Eigen::Vector3d middle = MiddleOf(finest, kFinest);
    const Eigen::Vector3d from_eye = middle + cell.moments.sum / cell.moments.count - eye;
    cell.moments.beams = cell.moments.count * from_eye.normalized();
    for (std::size_t level = 0; level < kLevels; ++level) {
      const Place place = Coarser(finest, static_cast<int>(level));
      const std::uint32_t voxel = tables_[level].FindOrMake(KeyOf(place));
      tables_[level][voxel].moments +=
          cell.moments.Shifted(middle - MiddleOf(place, Side(static_cast<int>(level))));
      if (voxel < planes_[level].size()) planes_[level][voxel].fresh = false;
    }
  }
  for (std::size_t level = 0; level < kLevels; ++level) {
    planes_[level].resize(tables_[level].size());
  }
}

void PlaneMap::Clear() {
  for (std::size_t level = 0; level < kLevels; ++level) {
    tables_[level].Clear();
    planes_[level].clear();
  }
}

void PlaneMap::Forget(const Eigen::Vector3d& place, double farther_m) {
  for (std::size_t level = 0; level < kLevels; ++level) {
    const double side = Side(static_cast<int>(level));
    tables_[level].KeepIf([&](const VoxelTable::Entry& entry) {
      return (MiddleOf(PlaceOf(entry.key), side) - place).norm() <= farther_m;
    });
    planes_[level].assign(tables_[level].size(), {});
  }
}

std::size_t PlaneMap::size() const {
  std::size_t all = 0;
  for (const VoxelTable& table : tables_) all += table.size();
  return all;
}

const Plane& PlaneMap::PlaneAt(std::size_t level, std::uint32_t voxel) const {
  Cached& cached = planes_[level][voxel];
  if (!cached.fresh) {
    const VoxelTable::Entry& entry = tables_[level][voxel];
    const double side = Side(static_cast<int>(level));
    cached = {PlaneOf(entry.moments, MiddleOf(PlaceOf(entry.key), side), side, range_sigma_m_),
              true};
  }
  return cached.plane;
}

Match PlaneMap::Find(const Eigen::Vector3d& point) const {
  // A larger voxel is as flat while its points lie across its plane as they do across the smaller
  // one's: so much more, for the smaller one may have few.
  constexpr double kMoreVariance = 1.5, kMore = 1e-5;  // [m^2]
  Match match;
  const std::optional<Place> finest = FinestPlace(point);
  if (!finest) return match;
  for (int level = 0; level < kLevels; ++level) {
    const auto l = static_cast<std::size_t>(level);
    const std::uint32_t voxel = tables_[l].Find(KeyOf(Coarser(*finest, level)));
    if (voxel == VoxelTable::kNone) continue;
    const Plane& plane = PlaneAt(l, voxel);
    const bool better =
        match.plane == nullptr || plane.variance <= kMoreVariance * match.plane->variance + kMore;
    if (plane.reliable && better) {
      match = {level, voxel, &plane};
    } else if (match.plane != nullptr) {
      break;
    }
  }
  return match;
}

}  // namespace rgbdt::odometry
