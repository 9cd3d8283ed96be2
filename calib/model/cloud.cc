#include "calib/model/cloud.h"

namespace rgbdt {

Eigen::Vector3f DirectionOf(const Cloud& cloud, std::size_t i) {
  if (!cloud.directions.empty()) {
    const Eigen::Vector3f& stored = cloud.directions[i];
    if (!cloud.IsHit(i) || stored.allFinite()) return stored;
  }
  const Eigen::Vector3f origin = cloud.origins.empty()
                                     ? Eigen::Vector3f(0, 0, 0)
                                     : cloud.origins[i / static_cast<std::size_t>(cloud.beams)];
  return (cloud.points[i] - origin).normalized();
}

int LostLines(const Cloud& cloud) {
  if (!cloud.organised || cloud.directions.size() != cloud.size()) return 0;
  const auto beams = static_cast<std::size_t>(cloud.beams);
  int lost = 0;
  for (std::size_t line = 0; line < static_cast<std::size_t>(cloud.lines); ++line) {
    bool any = false;
    for (std::size_t i = line * beams; i < (line + 1) * beams && !any; ++i) {
      any = cloud.IsHit(i) || cloud.directions[i].allFinite();
    }
    lost += any ? 0 : 1;
  }
  return lost;
}

}  // namespace rgbdt
