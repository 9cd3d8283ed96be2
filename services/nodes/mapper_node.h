#pragma once

#include <string>
#include <vector>

#include "calib/map/voxel_map.h"
#include "services/runtime/node.h"

namespace rgbdt {

/// RGBDT_CLOUD -> a voxel map; publishes nothing. Nothing waits; a late or repeated chunk is taken
/// like any other. With the first pose the map begins anew, in the pose stream's frame: what came
/// before lies nobody knows where. From then on a cloud without a pose is refused.
class MapperNode : public Node {
 public:
  explicit MapperNode(const VoxelMapOptions& options) : options_(options), map_(options) {}

  std::string name() const override { return "mapper"; }
  std::vector<std::string> Subscriptions() const override { return {"RGBDT_CLOUD"}; }
  Messages Handle(const Message& message) override;
  Status GetStatus() const override;

  const VoxelMap& map() const { return map_; }

 private:
  VoxelMapOptions options_;
  VoxelMap map_;
  std::int64_t clouds_ = 0;
};

}  // namespace rgbdt
