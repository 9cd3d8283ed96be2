#include "calib/simulate/internal/foliage.h"

#include <gtest/gtest.h>

#include "calib/simulate/internal/beam.h"
#include "tests/unit/simulate/simulate_testing.h"

namespace rgbdt::simulate {
namespace {

using Eigen::Vector3d;

/// A tree 6 m ahead before a wall at 12 m.
World TreeBeforeAWall(double leaves, const Options& options) {
  Dice draw(7, 0, "tree");
  Thing tree({295, 0});
  tree.AddAll(Standing(6, 0, -2, 0), MakeTree(&draw, {295, 0}, 5, leaves));
  auto scene = std::make_shared<SceneModel>();
  scene->objects = tree.parts();
  scene->objects.push_back(
      {"wall", MakeQuad({12, -9, -9}, {12, 9, -9}, {12, 9, 9}, {12, -9, 9}), {}});
  return {scene, std::nullopt, options};
}

/// Shares of the beams about the crown's middle that come back from the crown and from the wall.
std::pair<double, double> Shares(double leaves) {
  const Options options;
  const World world = TreeBeforeAWall(leaves, options);
  const std::vector<Vector3d> rays = SubRays(options.scanner, 0);
  int crown = 0, wall = 0, count = 0;
  for (double y = -0.9; y <= 0.9; y += 0.04) {
    for (double z = 0.9; z <= 1.9; z += 0.04) {
      const Vector3d direction = Vector3d(6, y, z).normalized();
      std::vector<Vector3d> cone;
      for (const Vector3d& ray : rays) {
        cone.push_back((ray - Vector3d::UnitX() + direction).normalized());
      }
      BeamReturn back;
      CastBeams(world, options.scanner, {0, 0, 0}, cone, static_cast<int>(rays.size()), &back);
      ++count;
      crown += back.range < 8 ? 1 : 0;
      wall += back.range > 11 ? 1 : 0;
    }
  }
  return {double(crown) / count, double(wall) / count};
}

TEST(Foliage, LetsPartOfTheBeamsPass) {
  const auto [crown, wall] = Shares(1);
  EXPECT_GT(crown, 0.3);
  EXPECT_GT(wall, 0.03);
  EXPECT_LT(wall, 0.7);
}

TEST(Foliage, IsDenserWithMoreLeaves) {
  EXPECT_LT(Shares(3).second, 0.7 * Shares(1).second);
  EXPECT_GT(Shares(0.2).second, 1.3 * Shares(1).second);
}

TEST(Foliage, IsAFewThousandTrianglesATree) {
  Dice draw(7, 0, "tree");
  const Thing tree = MakeTree(&draw, {295, 0}, 5, 1);
  const SceneObject& leaves = tree.parts().back();
  EXPECT_TRUE(leaves.material.leafy);
  EXPECT_GT(leaves.mesh.triangles.size(), 2000U);
  EXPECT_LT(leaves.mesh.triangles.size(), 6000U);
  for (const auto& triangle : leaves.mesh.triangles) {
    for (const unsigned i : triangle) ASSERT_LT(i, leaves.mesh.vertices.size());
  }
}

}  // namespace
}  // namespace rgbdt::simulate
