// What makes real thermal boards hard: heat, hands and people.
#include <gtest/gtest.h>

#include <cmath>

#include "calib/simulate/internal/camera_renderer.h"
#include "calib/simulate/internal/people.h"
#include "calib/simulate/internal/shading.h"
#include "tests/unit/simulate/simulate_testing.h"

namespace rgbdt::simulate {
namespace {

/// Facing the LIDAR, 3 m ahead.
Rigid3 Ahead() {
  Rigid3 pose;
  Eigen::Matrix3d facing;
  facing << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  pose.rotation = Eigen::Quaterniond(facing);
  pose.translation = {3, 0, 0.3};
  return pose;
}

World WorldOf(const Options& options) {
  auto scene = std::make_shared<SceneModel>(MakeScene(options));
  return {scene, Board(options.board, Ahead(), DrawHeat(options.board, scene->board_heat, 1, 0)),
          options};
}

/// What the LIDAR's origin sees in the direction of a place on the board.
Hit Look(const World& world, double x, double y) {
  return world.caster().Cast({0, 0, 0}, (Ahead() * Eigen::Vector3d(x, y, 0)).normalized());
}

double Kelvin(const World& world, double x, double y) {
  return SeeHeat(world, {0, 0, 0}, (Ahead() * Eigen::Vector3d(x, y, 0)).normalized(), 1e-3)
      .value[0];
}

double BoardKelvin(const Board& board, double x, double y) {
  int patch = 0;
  return board.At(board.lidar_from_target() * Eigen::Vector3d(x, y, 0), &patch).temperature_k;
}

TEST(HardBoards, NegativeContrastMakesBlackTheColderOne) {
  Options options;
  options.board.black_minus_white_k = -0.5;
  options.board.gradient_k = options.board.glow_k = 0;
  const World world = WorldOf(options);
  // The middle square of 11 x 8 and the one beside it.
  ASSERT_NE(world.board()->IsBlack(world.board()->Patch({0, 0.05})),
            world.board()->IsBlack(world.board()->Patch({0.1, 0.05})));
  const bool middle = world.board()->IsBlack(world.board()->Patch({0, 0.05}));
  const double difference =
      BoardKelvin(*world.board(), 0, 0.05) - BoardKelvin(*world.board(), 0.1, 0.05);
  EXPECT_NEAR(difference, middle ? -0.5 : 0.5, 1e-9);
}

TEST(HardBoards, GlowDwarfsTheContrast) {
  Options options;
  options.board.black_minus_white_k = 0.5;
  options.board.gradient_k = 0;
  options.board.glow_k = 5;
  options.board.glow_radius_m = 0.2;
  const World world = WorldOf(options);
  const Eigen::Vector2d centre = world.board()->heat().glow_centre;
  EXPECT_LT(std::abs(centre.x()), 0.35 * options.board.width_m);
  const HeatMap& heat = world.board()->heat();
  const Eigen::Vector2d far = centre - 0.8 * centre.normalized();  // 4 sigma
  EXPECT_NEAR(heat.At(centre, true) - heat.At(far, true), 5, 0.01);
}

TEST(HardBoards, BorderTakesOnTheWarmthThatIsAskedFor) {
  Options options;
  options.board.gradient_k = options.board.glow_k = 0;
  options.board.temperature_k = 305;
  options.board.black_minus_white_k = 2;
  EXPECT_NEAR(BoardKelvin(*WorldOf(options).board(), 0.58, 0), 306, 1e-9);  // as black
  options.board.border_to_white = 1;
  EXPECT_NEAR(BoardKelvin(*WorldOf(options).board(), 0.58, 0), 304, 1e-9);
  options.board.border_k = 297;
  const World world = WorldOf(options);
  EXPECT_NEAR(BoardKelvin(*world.board(), 0.58, 0), 297, 1e-9);
  EXPECT_NEAR(std::abs(BoardKelvin(*world.board(), 0.5, 0.05) - 305), 1, 1e-9);  // a square
  // The border's colour stays black: LIDAR and colour camera see no difference.
  EXPECT_EQ(world.board()->Reflectivity(Ahead() * Eigen::Vector3d(0.58, 0, 0)),
            options.board.black_reflectivity);
}

TEST(HardBoards, HandsReachOverTheBorderAndNoFarther) {
  Options options;
  options.holder.hands = 2;
  options.holder.hand_k = 308;
  const World world = WorldOf(options);
  const Options nobody;
  const World bare = WorldOf(nobody);
  int left = 0, right = 0;
  for (double y = -0.45; y < 0.45; y += 0.005) {
    for (const double side : {-1.0, 1.0}) {
      // The border's middle: the hand is in front of it or the board is seen.
      const Hit hit = Look(world, side * 0.58, y);
      EXPECT_TRUE(bare.IsBoard(Look(bare, side * 0.58, y)));
      if (world.IsBoard(hit)) continue;
      ++(side < 0 ? left : right);
      EXPECT_TRUE(world.IsMoving(hit));
      EXPECT_LT(hit.range, Look(bare, side * 0.58, y).range);
      const Eigen::Vector3d place = Ahead() * Eigen::Vector3d(side * 0.58, y, 0);
      EXPECT_EQ(world.Reflectivity(hit, place), 0.5);  // skin, for the LIDAR
      EXPECT_NEAR(Kelvin(world, side * 0.58, y),
                  ApparentTemperature(308, 0.95, world.scene().reflected_temperature_k), 1e-9);
      // No finger reaches the squares.
      EXPECT_TRUE(world.IsBoard(Look(world, side * 0.54, y)));
    }
  }
  // Four fingers of some 17 mm on each side.
  EXPECT_NEAR(0.005 * left, 0.068, 0.02);
  EXPECT_NEAR(0.005 * right, 0.068, 0.02);
  EXPECT_TRUE(world.IsBoard(Look(world, 0.2, -0.43)));  // nobody holds it above
}

TEST(HardBoards, APersonStandsCloseBehindAndDoesNotTouchTheBoard) {
  Options options;
  options.holder.person = true;
  options.holder.person_aside_m = 0.7;
  const World world = WorldOf(options);
  const World bare = WorldOf(Options());
  // To the left of the board as the LIDAR sees it: target x is to the right.
  const double warm = ApparentTemperature(options.world.person_temperature_k, 0.95,
                                          world.scene().reflected_temperature_k);
  EXPECT_NEAR(Kelvin(world, -0.78, 0.25), warm, 1.1);
  EXPECT_LT(Kelvin(bare, -0.78, 0.25), warm - 2);
  EXPECT_LT(Look(world, -0.78, 0.25).range, 4);
  for (const SceneObject& part : MakeHands(options, Ahead())) {
    for (const Eigen::Vector3d& vertex : part.mesh.vertices) {
      EXPECT_GT((Ahead().Inverse() * vertex).z(), options.board.thickness_m) << part.name;
    }
  }
  EXPECT_TRUE(MakeHands(Options(), Ahead()).empty());
}

TEST(HardBoards, RenderedAgainOnlyWhereHandsAndPersonAreEqualsRenderedInFull) {
  for (const std::size_t camera : {0U, 1U}) {
    Options options = SmallOptions();
    options.holder.hands = 4;
    options.holder.person = true;
    options.holder.person_aside_m = -0.6;
    const World world = WorldOf(options);
    const World empty(std::make_shared<SceneModel>(world.scene()), std::nullopt, options);
    const Rigid3 pose = DrawCameraFromLidar(options.cameras[camera], 1);
    CameraRenderer part(options.cameras[camera], pose, 3, 1);
    part.RenderEmpty(empty);
    part.Render(world);
    CameraRenderer full(options.cameras[camera], pose, 3, 1);
    full.RenderEmpty(world);
    full.ShowEmpty(world);
    EXPECT_EQ(cv::norm(full.clean(), part.clean(), cv::NORM_INF), 0);
  }
}

}  // namespace
}  // namespace rgbdt::simulate
