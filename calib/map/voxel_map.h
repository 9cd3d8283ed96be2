#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "calib/map/voxel_store.h"
#include "calib/model/map_cloud.h"
#include "calib/model/rgbdt_cloud.h"

namespace rgbdt {

struct VoxelMapOptions {
  double voxel_m = 0.1;                ///< edge of a voxel [m], 0.001 to 100
  std::size_t max_voxels = 5'000'000;  ///< 1 to 1e9; up to VoxelStore::kBytesPerVoxel each

  /// Throws InputError naming the field and its value.
  void Check() const;
};

/// Voxels of a chosen size, each with the mean of the points seen in it: place, colour,
/// temperature, how many, and when last. The frame is the pose stream's (RgbdtCloud's
/// map_from_lidar), or the LIDAR's where clouds come without a pose: then the rig is taken to stand
/// still.
///
/// Memory is bounded: a full map lets the voxel go that was not seen for the longest (in the order
/// in which points came; a point older than its voxel's newest leaves the order as it is). Each
/// point costs a constant time. The same clouds in the same order give the same map, bit for bit.
///
/// Colours are averaged over the points that have one, temperatures over those that have one,
/// weighed by 1/sigma^2 where a sigma is known and by 1 elsewhere. A mean is kept in floats: from
/// some ten million points a voxel on, new ones no longer move it.
class VoxelMap {
 public:
  explicit VoxelMap(const VoxelMapOptions& options);

  /// Throws InputError, and leaves the map as it was, for a cloud whose vectors differ in length
  /// (those of colour, temperature, its sigma and time may be empty) and for one with a pose where
  /// clouds without came before, or the reverse. A cloud without points changes nothing.
  void Add(const RgbdtCloud& cloud);

  std::size_t size() const { return store_.size(); }
  std::int64_t points() const { return points_; }    ///< taken in
  std::int64_t skipped() const { return skipped_; }  ///< not finite, or beyond 2^20 voxels
  std::int64_t evicted() const { return evicted_; }  ///< voxels that went because the map was full
  /// "map" or "lidar"; nothing before the first points.
  std::optional<std::string> frame() const;

  /// The voxels, sorted by their place: x, then y, then z.
  MapCloud Cloud() const;

 private:
  void CheckFrame(const RgbdtCloud& cloud);
  void AddBlock(const RgbdtCloud& cloud, std::size_t begin, std::size_t end);
  void AddPoint(const RgbdtCloud& cloud, std::size_t i, std::uint64_t key,
                const Eigen::Vector3d& in_map);

  VoxelMapOptions options_;
  double per_metre_;
  VoxelStore store_;
  std::optional<bool> posed_;
  std::int64_t points_ = 0, skipped_ = 0, evicted_ = 0;
};

}  // namespace rgbdt
