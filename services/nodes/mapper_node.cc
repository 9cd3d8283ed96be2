#include "services/nodes/mapper_node.h"

namespace rgbdt {

Messages MapperNode::Handle(const Message& message) {
  const auto* cloud = std::get_if<RgbdtCloud>(&message);
  if (cloud == nullptr) return {};
  if (cloud->map_from_lidar && map_.frame() == "lidar") map_ = VoxelMap(options_);
  map_.Add(*cloud);
  ++clouds_;
  return {};
}

Status MapperNode::GetStatus() const {
  Status status;
  status.ready = true;
  status.text =
      !map_.frame() ? "waits for clouds (RGBDT_CLOUD)"
      : *map_.frame() == "map"
          ? "mapping in the pose stream's frame"
          : "mapping in the LIDAR frame: no poses (POSE), the rig is taken to stand still";
  status.counters = {{"clouds", clouds_},
                     {"points", map_.points()},
                     {"voxels", static_cast<std::int64_t>(map_.size())},
                     {"voxels gone, map full", map_.evicted()},
                     {"points skipped", map_.skipped()}};
  return status;
}

}  // namespace rgbdt
