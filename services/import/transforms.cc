#include "services/import/transforms.h"

#include <deque>
#include <map>

namespace rgbdt {

std::optional<Rigid3> FindTransform(const std::vector<ros::Transform>& transforms,
                                    const std::string& to, const std::string& from) {
  if (to.empty() || from.empty()) return std::nullopt;
  // neighbours[a][b] = b_from_a
  std::map<std::string, std::map<std::string, Rigid3>> neighbours;
  for (const ros::Transform& transform : transforms) {
    neighbours[transform.child][transform.parent] = transform.parent_from_child;
    neighbours[transform.parent][transform.child] = transform.parent_from_child.Inverse();
  }
  std::map<std::string, Rigid3> reached = {{from, Rigid3()}};  // frame_from_from
  std::deque<std::string> next = {from};
  while (!next.empty() && reached.count(to) == 0) {
    const std::string frame = next.front();
    next.pop_front();
    for (const auto& [neighbour, neighbour_from_frame] : neighbours[frame]) {
      const Rigid3 pose = neighbour_from_frame * reached.at(frame);
      if (reached.emplace(neighbour, pose).second) next.push_back(neighbour);
    }
  }
  const auto found = reached.find(to);
  return found == reached.end() ? std::nullopt : std::optional<Rigid3>(found->second);
}

}  // namespace rgbdt
