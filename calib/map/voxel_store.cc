#include "calib/map/voxel_store.h"

#include <algorithm>

#include "calib/model/hash.h"

namespace rgbdt {
namespace {

constexpr int kBits = 21;  // an axis
constexpr std::uint64_t kMask = (std::uint64_t{1} << kBits) - 1;
constexpr std::size_t kFirstSlots = 1024;

}  // namespace

std::uint64_t VoxelStore::Key(std::int64_t x, std::int64_t y, std::int64_t z) {
  const auto shifted = [](std::int64_t i) {
    return static_cast<std::uint64_t>(i + kReach) & kMask;
  };
  return (shifted(x) << (2 * kBits)) | (shifted(y) << kBits) | shifted(z);
}

std::array<std::int64_t, 3> VoxelStore::Place(std::uint64_t key) {
  const auto axis = [key](int shift) {
    return static_cast<std::int64_t>((key >> shift) & kMask) - kReach;
  };
  return {axis(2 * kBits), axis(kBits), axis(0)};
}

VoxelStore::VoxelStore(std::size_t max_voxels)
    : max_voxels_(max_voxels), slots_(kFirstSlots, kNone) {}

std::size_t VoxelStore::Home(std::uint64_t key) const { return Hash(key) & (slots_.size() - 1); }

void VoxelStore::FetchSlot(std::uint64_t key) const { __builtin_prefetch(&slots_[Home(key)]); }

void VoxelStore::FetchVoxel(std::uint64_t key) const {
  const std::uint32_t entry = slots_[Home(key)];
  if (entry != kNone) __builtin_prefetch(&At(entry), 1);
}

std::size_t VoxelStore::SlotOf(std::uint64_t key) const {
  std::size_t slot = Home(key);
  while (slots_[slot] != kNone && At(slots_[slot]).key != key) {
    slot = (slot + 1) & (slots_.size() - 1);
  }
  return slot;
}

Voxel& VoxelStore::FindOrMake(std::uint64_t key, bool* evicted) {
  *evicted = false;
  // A beam's neighbour mostly falls into the same voxel.
  if (last_ != kNone && At(last_).key == key) return At(last_);
  std::size_t slot = SlotOf(key);
  if (slots_[slot] == kNone) {
    const std::uint32_t entry = NewEntry(evicted);
    slot = SlotOf(key);  // the index may have changed
    slots_[slot] = entry;
    At(entry) = Voxel();
    At(entry).key = key;
    LinkNewest(entry);
  }
  last_ = slots_[slot];
  return At(last_);
}

void VoxelStore::Touch() {
  if (last_ == newest_) return;
  Unlink(last_);
  LinkNewest(last_);
}

std::uint32_t VoxelStore::NewEntry(bool* evicted) {
  if (size_ == max_voxels_) {
    const std::uint32_t entry = oldest_;
    Erase(At(entry).key);
    Unlink(entry);
    *evicted = true;
    return entry;
  }
  if (2 * (size_ + 1) > slots_.size()) GrowIndex();
  if (size_ == blocks_.size() * kBlock) {
    const std::size_t left = max_voxels_ - size_;
    blocks_.push_back(std::make_unique<Voxel[]>(std::min(left, kBlock)));
  }
  return static_cast<std::uint32_t>(size_++);
}

void VoxelStore::Erase(std::uint64_t key) {
  const std::size_t mask = slots_.size() - 1;
  std::size_t hole = SlotOf(key);
  for (std::size_t next = (hole + 1) & mask; slots_[next] != kNone; next = (next + 1) & mask) {
    const std::size_t home = Home(At(slots_[next]).key);
    // What probing from its home would find only beyond the hole moves into it.
    if (((next - home) & mask) >= ((next - hole) & mask)) {
      slots_[hole] = slots_[next];
      hole = next;
    }
  }
  slots_[hole] = kNone;
}

void VoxelStore::GrowIndex() {
  slots_.assign(2 * slots_.size(), kNone);
  for (std::uint32_t entry = 0; entry < size_; ++entry) slots_[SlotOf(At(entry).key)] = entry;
}

void VoxelStore::Unlink(std::uint32_t entry) {
  const Voxel& voxel = At(entry);
  (voxel.older == kNone ? oldest_ : At(voxel.older).newer) = voxel.newer;
  (voxel.newer == kNone ? newest_ : At(voxel.newer).older) = voxel.older;
}

void VoxelStore::LinkNewest(std::uint32_t entry) {
  At(entry).older = newest_;
  At(entry).newer = kNone;
  (newest_ == kNone ? oldest_ : At(newest_).newer) = entry;
  newest_ = entry;
}

std::vector<const Voxel*> VoxelStore::Sorted() const {
  std::vector<const Voxel*> sorted;
  sorted.reserve(size_);
  for (std::uint32_t entry = 0; entry < size_; ++entry) sorted.push_back(&At(entry));
  std::sort(sorted.begin(), sorted.end(),
            [](const Voxel* a, const Voxel* b) { return a->key < b->key; });
  return sorted;
}

}  // namespace rgbdt
