#include "calib/monitor/still_cloud.h"

#include <limits>

namespace rgbdt {
namespace {

constexpr double kMostUntold = 0.1;  // of the points

}  // namespace

std::optional<Cloud> AsSeenAt(Cloud cloud, const PoseTrack& poses, Utime moment) {
  if (poses.empty() || cloud.utime.empty()) return cloud;
  const std::optional<Rigid3> map_from_moment = poses.At(moment);
  if (!map_from_moment) return std::nullopt;
  const Rigid3 moment_from_map = map_from_moment->Inverse();
  const Eigen::Vector3f nan = Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
  Utime time = 0;
  std::optional<Rigid3> moment_from_then;
  std::size_t untold = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (i == 0 || cloud.utime[i] != time) {  // beams that fire together come one after the other
      time = cloud.utime[i];
      const std::optional<Rigid3> then = poses.At(time);
      moment_from_then.reset();
      if (then) moment_from_then = moment_from_map * *then;
    }
    Eigen::Vector3f* direction = cloud.directions.empty() ? nullptr : &cloud.directions[i];
    if (!moment_from_then) {
      ++untold;
      cloud.points[i] = nan;
      if (direction != nullptr) *direction = nan;
      continue;
    }
    const Eigen::Vector3d point = *moment_from_then * cloud.points[i].cast<double>().eval();
    cloud.points[i] = point.cast<float>();
    if (direction == nullptr) continue;
    *direction = (moment_from_then->rotation * direction->cast<double>()).cast<float>();
  }
  // Where beams start moves by as much as the rig did within the sweep: less than what it stands
  // beside the LIDAR's own frame by, and only directions of misses are made of it.
  if (static_cast<double>(untold) > kMostUntold * static_cast<double>(cloud.size())) {
    return std::nullopt;
  }
  return cloud;
}

}  // namespace rgbdt
