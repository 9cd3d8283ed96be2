#include "services/nodes/mapper_node.h"

#include <algorithm>
#include <utility>

#include "calib/files/points/map_files.h"

namespace rgbdt {

MapperNode::MapperNode(const VoxelMapOptions& options, std::filesystem::path file, Utime every)
    : options_(options), file_(std::move(file)), every_(every), map_(options) {}

Messages MapperNode::Handle(const Message& message) {
  const auto* cloud = std::get_if<RgbdtCloud>(&message);
  if (cloud == nullptr) return {};
  if (cloud->map_from_lidar && map_.frame() == "lidar") {
    VoxelMap begun_anew(options_);
    begun_anew.Add(*cloud);
    map_ = std::move(begun_anew);
  } else {
    map_.Add(*cloud);
  }
  ++clouds_;
  return {};
}

void MapperNode::Save() {
  if (file_.empty() || map_.points() == saved_points_) return;
  WriteMapPly(file_, map_.Cloud());
  saved_points_ = map_.points();
}

Messages MapperNode::Advance(Utime now) {
  if (save_began_) {  // how long it took is known by now
    due_ = now + std::max(every_, 10 * (now - *save_began_));
    save_began_.reset();
  }
  if (now < due_ || file_.empty() || map_.points() == saved_points_) return {};
  save_began_ = now;
  // A full disk may have room again; the map itself is not lost.
  try {
    Save();
  } catch (const std::exception& e) {
    Warn(e.what());
  }
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
