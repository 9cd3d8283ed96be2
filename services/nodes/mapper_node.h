#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "calib/map/voxel_map.h"
#include "services/runtime/node.h"

namespace rgbdt {

/// RGBDT_CLOUD -> a voxel map; publishes nothing, writes the map's file. Nothing waits; a late or
/// repeated chunk is taken like any other. With the first pose the map begins anew, in the pose
/// stream's frame: what came before lies nobody knows where. From then on a cloud without a pose is
/// refused.
class MapperNode : public Node {
 public:
  /// `file`: where Advance writes the map (PLY) when it has changed, at most once in `every` [us],
  /// and for no more than a tenth of the time: a large map takes long to write. Empty: nowhere.
  explicit MapperNode(const VoxelMapOptions& options, std::filesystem::path file = {},
                      Utime every = 5 * kMicrosecondsPerSecond);

  std::string name() const override { return "mapper"; }
  std::vector<std::string> Subscriptions() const override { return {"RGBDT_CLOUD"}; }
  Messages Handle(const Message& message) override;
  Messages Advance(Utime now) override;
  Status GetStatus() const override;

  /// Writes the map if it has changed since. Throws InputError where that fails.
  void Save();

  const VoxelMap& map() const { return map_; }

 private:
  VoxelMapOptions options_;
  std::filesystem::path file_;
  Utime every_;
  VoxelMap map_;
  std::int64_t clouds_ = 0;
  std::int64_t saved_points_ = 0;
  Utime due_ = 0;
  std::optional<Utime> save_began_;  // in the last Advance
};

}  // namespace rgbdt
