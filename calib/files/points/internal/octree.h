#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace rgbdt::laz {

/// Points in a cube that is halved again and again, each point in one node: a coarse node has at
/// most one of each of its 128^3 cells, and hands the others down. A node of few points keeps them
/// all, and those that would be too few for a child of their own. All in whole numbers: a point is
/// never outside of its node by rounding.
struct Octree {
  struct Node {
    std::uint32_t level = 0;
    std::array<std::uint32_t, 3> at{};  ///< in nodes of this level, from the least corner on
    std::vector<std::uint32_t> points;  ///< rising
  };

  std::array<std::int64_t, 3> least{};
  std::int64_t side = 0;
  std::vector<Node> nodes;  ///< by level; within a level by the order of their parents
};

inline constexpr std::int64_t kCellsAlong = 128;

struct OctreeSettings {
  std::size_t most_whole = 20'000;  ///< a node of so many points, or fewer, is not divided
  std::size_t least_child = 500;    ///< fewer stay with the parent
};

Octree MakeOctree(const std::vector<std::array<std::int32_t, 3>>& points,
                  const OctreeSettings& settings = {});

}  // namespace rgbdt::laz
