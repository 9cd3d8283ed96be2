#include "calib/simulate/internal/board_poses.h"

#include <gtest/gtest.h>

#include <cmath>

#include "calib/model/errors.h"
#include "tests/unit/simulate/simulate_testing.h"

namespace rgbdt::simulate {
namespace {

/// What decides on poses, without rendering anything.
struct Setting {
  explicit Setting(const Options& o)
      : options(o),
        scene(std::make_shared<SceneModel>(MakeScene(o))),
        empty(scene, std::nullopt, o),
        scanner(o.scanner, o.seed) {
    for (const CameraOptions& camera : o.cameras) {
      cameras.emplace_back(camera, DrawCameraFromLidar(camera, o.seed), 1, 1);
    }
  }
  Rigid3 Pose(int index) const { return BoardPose(options, empty, scanner, cameras, index); }

  Options options;
  std::shared_ptr<const SceneModel> scene;
  World empty;
  Scanner scanner;
  std::vector<CameraRenderer> cameras;
};

std::vector<Eigen::Vector3d> Outline(const BoardOptions& board) {
  const auto corners = MakeTarget(board).OutlineCorners();
  std::vector<Eigen::Vector3d> places;
  for (std::size_t side = 0; side < 4; ++side) {
    for (int i = 0; i < 10; ++i) {
      places.emplace_back(corners[side] + (corners[(side + 1) % 4] - corners[side]) * (i / 10.0));
    }
  }
  return places;
}

void ExpectWithinLimits(const Setting& s, const Rigid3& lidar_from_target) {
  const Eigen::Vector3d sight = lidar_from_target.translation.normalized();
  EXPECT_GE(lidar_from_target.translation.norm(), 2);
  EXPECT_LE(lidar_from_target.translation.norm(), 6);
  const Eigen::Vector3d normal = lidar_from_target.rotation * Eigen::Vector3d::UnitZ();
  EXPECT_LE(std::acos(normal.dot(sight)), 40 * kDegree);
  // Its top left corner stays its top left: turned by less than 45 degrees, seen from the LIDAR.
  const Eigen::Vector3d x = lidar_from_target.rotation * Eigen::Vector3d::UnitX();
  EXPECT_LT(x.dot(Eigen::Vector3d::UnitZ().cross(sight)), 0);
  std::vector<Eigen::Vector3d> outline = Outline(s.options.board);
  for (const Eigen::Vector3d& place : outline) {
    const Eigen::Vector3d p = lidar_from_target * place;
    EXPECT_LT(std::abs(std::atan2(p.y(), p.x())), 29 * kDegree);
    EXPECT_LT(std::abs(std::atan2(p.z(), p.head<2>().norm())), 39 * kDegree);
    EXPECT_GT(p.z(), s.options.world.ground_z_m + 0.29);
  }
  for (const CameraRenderer& camera : s.cameras) {
    const CameraOptions& o = camera.options();
    for (const cv::Point2d& pixel :
         OpenCvPixels(o.lens, camera.camera_from_lidar() * lidar_from_target, outline)) {
      EXPECT_TRUE(pixel.x > 10 && pixel.y > 10 && pixel.x < o.width - 11 && pixel.y < o.height - 11)
          << o.name << " " << pixel;
    }
  }
}

/// Beams at the board's places meet the board itself.
void ExpectUnobstructed(const Setting& s, const Rigid3& lidar_from_target) {
  const World world(s.scene, Board(s.options.board, lidar_from_target, {}), s.options);
  std::vector<Eigen::Vector3d> eyes{s.scanner.Centre(0)};
  for (const CameraRenderer& camera : s.cameras) eyes.push_back(camera.CentreInLidar());
  for (const Eigen::Vector3d& eye : eyes) {
    for (const Eigen::Vector3d& place : Outline(s.options.board)) {
      const Eigen::Vector3d target = lidar_from_target * Eigen::Vector3d(0.999 * place);
      const Hit hit = world.caster().Cast(eye, (target - eye).normalized());
      EXPECT_TRUE(world.IsBoard(hit));
      EXPECT_NEAR(hit.range, (target - eye).norm(), 1e-4);
    }
  }
}

TEST(BoardPoses, StayWithinTheirLimits) {
  for (const Scene scene : {Scene::kOutdoor, Scene::kIndoor, Scene::kNight}) {
    for (const std::uint64_t seed : {1, 2, 3, 4, 5}) {
      Options options;
      options.scene = scene;
      options.seed = seed;
      const Setting setting(options);
      for (int index = 0; index < 15; ++index) {
        SCOPED_TRACE("scene " + std::to_string(static_cast<int>(scene)) + " seed " +
                     std::to_string(seed) + " index " + std::to_string(index));
        const Rigid3 pose = setting.Pose(index);
        ExpectWithinLimits(setting, pose);
        ExpectUnobstructed(setting, pose);
      }
    }
  }
}

TEST(BoardPoses, SpreadOverFieldRangeAndTilt) {
  const Setting setting{Options()};
  Eigen::Vector3d low(1e9, 1e9, 1e9), high = -low;
  Eigen::Vector3d normals_low = low, normals_high = high;
  for (int index = 0; index < 12; ++index) {
    const Rigid3 pose = setting.Pose(index);
    const Eigen::Vector3d p = pose.translation;
    const Eigen::Vector3d seen(std::atan2(p.y(), p.x()), std::asin(p.z() / p.norm()), p.norm());
    low = low.cwiseMin(seen);
    high = high.cwiseMax(seen);
    const Eigen::Vector3d normal = pose.rotation * Eigen::Vector3d::UnitZ();
    normals_low = normals_low.cwiseMin(normal);
    normals_high = normals_high.cwiseMax(normal);
  }
  EXPECT_GT(high.x() - low.x(), 25 * kDegree);
  EXPECT_GT(high.y() - low.y(), 12 * kDegree);
  EXPECT_GT(high.z() - low.z(), 2.0);
  EXPECT_GT(normals_high.y() - normals_low.y(), 0.8);
  EXPECT_GT(normals_high.z() - normals_low.z(), 0.8);
}

TEST(BoardPoses, DoNotDependOnTheOrderOfViews) {
  const Setting setting{Options()};
  const Rigid3 third = setting.Pose(3);
  setting.Pose(0);
  EXPECT_EQ(setting.Pose(3).translation, third.translation);
  Options other;
  other.seed = 2;
  EXPECT_NE(Setting(other).Pose(3).translation, third.translation);
}

TEST(BoardPoses, SayWhenThereIsNoRoom) {
  Options options;
  options.pose.min_range_m = options.pose.max_range_m = 0.6;
  EXPECT_THROW(Setting(options).Pose(0), InputError);
}

TEST(BoardPoses, TheShareThatIsAskedForLiesOutsideTheImage) {
  for (const double asked : {0.15, 0.4}) {
    Options options;
    options.cameras.erase(options.cameras.begin());  // thermal alone
    options.pose.outside_image = asked;
    const Setting s(options);
    for (int index = 0; index < 4; ++index) {
      const Rigid3 camera_from_target = s.cameras[0].camera_from_lidar() * s.Pose(index);
      int outside = 0, all = 0;
      for (double x = -0.6; x <= 0.6; x += 0.05) {
        for (double y = -0.45; y <= 0.45; y += 0.05) {
          const auto pixel =
              s.cameras[0].lens().Project(camera_from_target * Eigen::Vector3d(x, y, 0));
          const bool seen =
              pixel && pixel->x() > 0 && pixel->y() > 0 && pixel->x() < 639 && pixel->y() < 479;
          outside += seen ? 0 : 1;
          ++all;
        }
      }
      // Within 0.05, and what this coarser grid may miss.
      EXPECT_NEAR(double(outside) / all, asked, 0.07) << index;
    }
  }
}

}  // namespace
}  // namespace rgbdt::simulate
