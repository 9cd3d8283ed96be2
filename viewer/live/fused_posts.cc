#include "viewer/live/fused_posts.h"

#include <string>
#include <utility>

#include "calib/present/frames/cloud_frame.h"

namespace rgbdt::viewer {

bool FusedPosts::Add(const RgbdtCloud& cloud, Outbox* outbox) {
  auto shared = std::make_shared<const RgbdtCloud>(cloud);
  if (!cloud.whole_sweep) {
    const auto number = static_cast<int>(cloud.seq % 1'000'000'000);
    outbox->Send({"chunk/" + std::to_string(cloud.seq), "cloud", false, true, kPointBytes,
                  [shared, number] { return CloudFrame(*shared, number); }, true});
    return false;
  }
  if (cloud.sweep_utime != sweep_utime_) {
    sweep_utime_ = cloud.sweep_utime;
    part_ = 0;
    points_.clear();
    outbox->Forget("sweep/");
  }
  const int part = part_++;
  outbox->Send({"sweep/" + std::to_string(part), "cloud", true, true, kPointBytes,
                [shared, part] { return CloudFrame(*shared, part); }, true});
  if (points_.size() < kMaxPoints) {
    points_.insert(points_.end(), cloud.points.begin(), cloud.points.end());
  }
  if (!cloud.sweep_end) return false;
  whole_sweep_ = std::make_shared<const std::vector<Eigen::Vector3f>>(std::exchange(points_, {}));
  return true;
}

}  // namespace rgbdt::viewer
