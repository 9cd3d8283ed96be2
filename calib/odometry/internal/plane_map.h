#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace rgbdt::odometry {

/// A plane through the points of a voxel, and how well they tell it.
struct Plane {
  bool reliable = false;
  Eigen::Vector3d mean{0, 0, 0};
  Eigen::Vector3d normal{0, 0, 1};  ///< unit, either way
  /// Of a small tilt of the normal, as a vector across it: its covariance [rad^2].
  Eigen::Matrix3d normal_covariance = Eigen::Matrix3d::Zero();
  double variance = 0;       ///< [m^2] of the points across the plane
  double mean_variance = 0;  ///< [m^2] of the mean across the plane
};

/// Sums over the points of a voxel, about its middle.
struct Moments {
  double count = 0;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  std::array<double, 6> outer{};                    ///< xx, xy, xz, yy, yz, zz
  Eigen::Vector3d beams = Eigen::Vector3d::Zero();  ///< unit vectors from the LIDAR
  std::uint64_t lines = 0;  ///< which lines they are of, a bit each (some share one)

  void Add(const Eigen::Vector3d& p);
  /// Of the same points about another middle: `shift` = this middle - the other one.
  Moments Shifted(const Eigen::Vector3d& shift) const;
  Moments& operator+=(const Moments& other);
  Eigen::Matrix3d Covariance() const;
};

/// The plane of a voxel with this middle and side [m]. Noise of ranges lies along the beams, and
/// makes a plane of least distances lean towards them: what it adds to the covariance is taken out.
/// Points of one line lie on a ring's cone, which looks like a plane wherever they lie: no plane is
/// reliable by fewer than two.
Plane PlaneOf(const Moments& moments, const Eigen::Vector3d& middle, double side,
              double range_sigma_m);

/// Voxels of one size by their place: a hash map with linear probing over entries in the order in
/// which they were made.
class VoxelTable {
 public:
  static constexpr std::uint32_t kNone = 0xffffffff;
  struct Entry {
    std::uint64_t key = 0;
    Moments moments;
  };

  VoxelTable();
  std::size_t size() const { return entries_.size(); }
  const Entry& operator[](std::uint32_t entry) const { return entries_[entry]; }
  Entry& operator[](std::uint32_t entry) { return entries_[entry]; }
  std::uint32_t Find(std::uint64_t key) const;
  std::uint32_t FindOrMake(std::uint64_t key);
  void Clear();
  /// Keeps those of which `keep(entry)` is true, in their order.
  template <typename Keep>
  void KeepIf(const Keep& keep) {
    std::size_t kept = 0;
    for (const Entry& entry : entries_) {
      if (keep(entry)) entries_[kept++] = entry;
    }
    entries_.resize(kept);
    Index(slots_.size());
  }

 private:
  void Index(std::size_t slots);
  std::size_t SlotOf(std::uint64_t key) const;

  struct Slot {
    std::uint64_t key = 0;
    std::uint32_t entry = kNone;
  };

  std::vector<Entry> entries_;
  std::vector<Slot> slots_;  // a power of two, at most half of them taken
};

/// Which voxel's plane a point lies on.
struct Match {
  int level = -1;
  std::uint32_t voxel = 0;
  const Plane* plane = nullptr;  ///< good until the map changes; null: none
};

struct MapPoint {
  Eigen::Vector3d place;        ///< [m]
  std::uint32_t elevation = 0;  ///< number of the ring, or of a narrow interval of elevations
};

/// Points in voxels of 0.2, 0.4, 0.8 and 1.6 m side, of each the mean and covariance. World frame.
class PlaneMap {
 public:
  static constexpr int kLevels = 4;
  static constexpr double kFinest = 0.2;  ///< [m]
  static double Side(int level) { return kFinest * (1 << level); }

  explicit PlaneMap(double range_sigma_m) : range_sigma_m_(range_sigma_m) {}

  /// Points seen from about `eye`. A ring's are one line until the eye has moved.
  void Add(const std::vector<MapPoint>& points, const Eigen::Vector3d& eye);
  void Clear();
  /// Forgets voxels whose middle is farther than this from a place.
  void Forget(const Eigen::Vector3d& place, double farther_m);
  std::size_t size() const;
  std::size_t size(int level) const { return tables_[static_cast<std::size_t>(level)].size(); }

  /// The plane of the smallest voxel about the point that has a reliable one, or of a larger one
  /// as long as that is as flat.
  Match Find(const Eigen::Vector3d& point) const;

 private:
  struct Cached {
    Plane plane;
    bool fresh = false;
  };
  const Plane& PlaneAt(std::size_t level, std::uint32_t voxel) const;

  double range_sigma_m_;
  std::array<VoxelTable, kLevels> tables_;
  mutable std::array<std::vector<Cached>, kLevels> planes_;  // computed when asked for
  VoxelTable sweep_;                                         // of Add: the points of one sweep
  std::uint32_t station_ = 0;                                // counts the eye's moves
  Eigen::Vector3d station_eye_{0, 0, 0};
};

}  // namespace rgbdt::odometry
