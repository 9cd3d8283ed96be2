#pragma once

#include <string>
#include <vector>

#include "calib/map/voxel_map.h"
#include "services/nodes/node.h"

namespace rgbdt {

/// RGBDT_CLOUD -> a voxel map; publishes nothing. Chunks are taken as they come, whole sweeps
/// (`whole_sweep`: the same points once more, better coloured) are left out and counted where
/// chunks came before. Nothing waits; a late or repeated chunk is taken like any other. A cloud
/// with a pose after clouds without, or the reverse, is refused (voxel_map.h).
class MapperNode : public Node {
 public:
  explicit MapperNode(const VoxelMapOptions& options) : map_(options) {}

  std::string name() const override { return "mapper"; }
  std::vector<std::string> Subscriptions() const override { return {"RGBDT_CLOUD"}; }
  Messages Handle(const Message& message) override;
  Status GetStatus() const override;

  const VoxelMap& map() const { return map_; }

 private:
  VoxelMap map_;
  std::int64_t clouds_ = 0, repeated_ = 0;
  bool chunks_seen_ = false;
};

}  // namespace rgbdt
