#include "calib/files/points/internal/octree.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

namespace rgbdt::laz {
namespace {

using Place = std::array<std::int32_t, 3>;
using Node = Octree::Node;

// The side is 128 to 255 times 2^levels (or less than 128), so that it can be halved as often, and
// is hardly longer than the cloud. A step of room on each side, for who computes in metres.
struct Cube {
  std::array<std::int64_t, 3> least{};
  std::int64_t side = 0;
  std::uint32_t levels = 0;
};

Cube CubeAround(const std::vector<Place>& points) {
  std::array<std::int64_t, 3> least{}, most{};
  least.fill(std::numeric_limits<std::int32_t>::max());
  most.fill(std::numeric_limits<std::int32_t>::min());
  for (const Place& point : points) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      least[axis] = std::min<std::int64_t>(least[axis], point[axis]);
      most[axis] = std::max<std::int64_t>(most[axis], point[axis]);
    }
  }
  std::int64_t extent = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    extent = std::max(extent, most[axis] - least[axis] + 3);
  }
  Cube cube;
  while (extent > kCellsAlong << (cube.levels + 1)) ++cube.levels;
  const std::int64_t smallest = std::int64_t{1} << cube.levels;
  cube.side = (extent + smallest - 1) / smallest * smallest;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    cube.least[axis] = least[axis] - (cube.side - (most[axis] - least[axis] + 1)) / 2;
  }
  return cube;
}

class Divider {
 public:
  Divider(const std::vector<Place>& points, const Cube& cube, const OctreeSettings& settings)
      : points_(points),
        cube_(cube),
        settings_(settings),
        taken_(static_cast<std::size_t>(kCellsAlong * kCellsAlong * kCellsAlong)) {}

  // Leaves with the node what is its own, and gives the others by child.
  std::vector<Node> Divide(Node* node) {
    if (node->points.size() <= settings_.most_whole || node->level == cube_.levels) return {};
    std::vector<Node> children = ChildrenOf(*node);
    std::vector<std::uint32_t> kept, cells;
    for (const std::uint32_t point : node->points) {
      const auto [cell, child] = WhereIn(*node, point);
      if (taken_[cell]) {
        children[child].points.push_back(point);
        continue;
      }
      taken_[cell] = true;
      cells.push_back(cell);
      kept.push_back(point);
    }
    for (const std::uint32_t cell : cells) taken_[cell] = false;
    node->points = std::move(kept);
    TakeBack(&children, node);
    return children;
  }

 private:
  static std::vector<Node> ChildrenOf(const Node& node) {
    std::vector<Node> children(8);
    for (std::uint32_t i = 0; i < 8; ++i) {
      children[i].level = node.level + 1;
      for (std::uint32_t axis = 0; axis < 3; ++axis) {
        children[i].at[axis] = 2 * node.at[axis] + ((i >> axis) & 1);
      }
    }
    return children;
  }

  // Which of the 128^3 cells of the node, and which of the 8 children.
  std::pair<std::uint32_t, std::uint32_t> WhereIn(const Node& node, std::uint32_t point) const {
    const std::int64_t side = cube_.side >> node.level;
    std::uint32_t cell = 0, child = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::int64_t within = points_[point][axis] - cube_.least[axis] - node.at[axis] * side;
      cell = cell * kCellsAlong + static_cast<std::uint32_t>(within * kCellsAlong / side);
      child |= (within >= side / 2 ? 1U : 0U) << axis;
    }
    return {cell, child};
  }

  void TakeBack(std::vector<Node>* children, Node* node) const {
    const auto few = std::stable_partition(
        children->begin(), children->end(),
        [&](const Node& child) { return child.points.size() >= settings_.least_child; });
    for (auto child = few; child != children->end(); ++child) {
      node->points.insert(node->points.end(), child->points.begin(), child->points.end());
    }
    children->erase(few, children->end());
    std::sort(node->points.begin(), node->points.end());
  }

  const std::vector<Place>& points_;
  Cube cube_;
  OctreeSettings settings_;
  std::vector<bool> taken_;  // by cell
};

}  // namespace

Octree MakeOctree(const std::vector<Place>& points, const OctreeSettings& settings) {
  const Cube cube = CubeAround(points);
  Octree octree;
  octree.least = cube.least;
  octree.side = cube.side;
  octree.nodes.emplace_back();
  octree.nodes[0].points.resize(points.size());
  std::iota(octree.nodes[0].points.begin(), octree.nodes[0].points.end(), 0);
  Divider divider(points, cube, settings);
  for (std::size_t i = 0; i < octree.nodes.size(); ++i) {
    for (Node& child : divider.Divide(&octree.nodes[i])) octree.nodes.push_back(std::move(child));
  }
  return octree;
}

}  // namespace rgbdt::laz
