#pragma once

// Inside calib/map only: voxels by key, in the order in which they were last touched.

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "calib/model/time.h"

namespace rgbdt {

/// Means of the points in a voxel. 64 bytes: one line of a processor's cache.
struct Voxel {
  std::uint64_t key = 0;                  ///< of its place, see VoxelStore
  std::array<float, 3> offset{};          ///< mean place [m] from the voxel's lowest corner
  std::array<float, 3> rgb{};             ///< mean of `coloured` points
  float temperature_k = 0;                ///< weighted mean; valid where the weight is above 0
  float weight = 0;                       ///< sum of 1/sigma^2 [1/K^2]
  std::uint32_t count = 0, coloured = 0;  ///< points; of those with a colour
  Utime last_seen = 0;
  std::uint32_t older = 0, newer = 0;  ///< neighbours in the order of touch
};
static_assert(sizeof(Voxel) == 64);

/// A hash map with linear probing (Knuth 6.4, deletion by moving back: algorithm R) over entries in
/// blocks that never move, threaded on a list by when they were touched. Takes memory as it fills,
/// kBytesPerVoxel a voxel at most.
class VoxelStore {
 public:
  static constexpr std::uint32_t kNone = 0xffffffff;
  /// The index has at most four slots of 4 bytes a voxel.
  static constexpr std::size_t kBytesPerVoxel = sizeof(Voxel) + 16;
  /// Voxels from the origin, along each axis, that a key holds: -kReach <= i < kReach.
  static constexpr std::int64_t kReach = std::int64_t{1} << 20;

  /// x, then y, then z, in the key's order; each within kReach.
  static std::uint64_t Key(std::int64_t x, std::int64_t y, std::int64_t z);
  static std::array<std::int64_t, 3> Place(std::uint64_t key);

  explicit VoxelStore(std::size_t max_voxels);

  std::size_t size() const { return size_; }
  /// Asks the processor for the memory that FindOrMake will want; FetchSlot some time ahead.
  void FetchSlot(std::uint64_t key) const;
  void FetchVoxel(std::uint64_t key) const;
  /// The voxel of this key, made empty (count 0) where there is none. `evicted` is set where
  /// another went for it: the one touched longest ago. Good until the next call.
  Voxel& FindOrMake(std::uint64_t key, bool* evicted);
  /// Makes the voxel that FindOrMake gave last the newest in the order.
  void Touch();
  /// All of them, in the order of keys.
  std::vector<const Voxel*> Sorted() const;

 private:
  static constexpr std::size_t kBlock = 1 << 14;

  Voxel& At(std::uint32_t entry) { return blocks_[entry / kBlock][entry % kBlock]; }
  const Voxel& At(std::uint32_t entry) const { return blocks_[entry / kBlock][entry % kBlock]; }
  std::size_t Home(std::uint64_t key) const;
  std::size_t SlotOf(std::uint64_t key) const;  // its own or the first free one
  std::uint32_t NewEntry(bool* evicted);
  void Erase(std::uint64_t key);
  void GrowIndex();
  void Unlink(std::uint32_t entry);
  void LinkNewest(std::uint32_t entry);

  std::size_t max_voxels_;
  std::size_t size_ = 0;
  std::vector<std::unique_ptr<Voxel[]>> blocks_;
  std::vector<std::uint32_t> slots_;  // a power of two, at most half of them taken
  std::uint32_t oldest_ = kNone, newest_ = kNone, last_ = kNone;
};

}  // namespace rgbdt
