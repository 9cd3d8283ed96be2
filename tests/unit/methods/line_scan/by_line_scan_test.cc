#include "calib/methods/line_scan/by_line_scan.h"

#include <cmath>

#include "calib/methods/calibrate.h"
#include "calib/methods/line_scan/board_lines.h"
#include "tests/unit/methods/scanned_board.h"
#include "tests/unit/solve/solve_world.h"

namespace rgbdt {
namespace {

using testing::HasSubstr;

constexpr int kLevelRing = 8;  // of SolveWorld's 16

SolveWorldOptions Ringed(double noise, int views = 20, std::uint32_t seed = 1) {
  SolveWorldOptions options;
  options.noise = noise;
  options.views = views;
  options.seed = seed;
  options.rings = SolveWorldOptions::Rings{};
  return options;
}

// Images without noise: the planes are exact, as the method takes them to be.
void MakePlanesExact(SolveWorld* world) {
  for (std::size_t v = 0; v < world->lidar_from_target.size(); ++v) {
    for (std::size_t c = 0; c < 2; ++c) {
      world->ImageAt(v, c).pose->sensor_from_target =
          world->camera_from_lidar[c] * world->lidar_from_target[v];
    }
  }
}

CameraCalibration SolveCamera(const SolveWorld& world, std::size_t camera) {
  CameraViews views = ViewsOf(world.rig.cameras[camera], world.detections);
  return SolveLineScan(&views);
}

std::vector<LineOnBoard> LinesOf(const SolveWorld& world, std::size_t camera, int ring) {
  std::vector<LineOnBoard> lines;
  for (std::size_t v = 0; v < world.lidar_from_target.size(); ++v) {
    const CloudEdges& cloud = world.detections[v].cloud.candidates.at(0);
    const Rigid3 board = world.camera_from_lidar[camera] * world.lidar_from_target[v];
    LineOnBoard line;
    line.normal = board.rotation * Eigen::Vector3d::UnitZ();
    line.offset_m = line.normal.dot(board.translation);
    Eigen::Matrix4d from_centre = Eigen::Matrix4d::Identity();
    from_centre.topRightCorner<3, 1>() = cloud.centre;
    for (const PointGroup& group : cloud.groups) {
      if (group.ring == ring) line.sums += from_centre * group.scatter * from_centre.transpose();
    }
    if (line.sums(3, 3) > 0) lines.push_back(line);
  }
  return lines;
}

TEST(LinearStart, OfALevelLineIsExact) {
  const SolveWorld world(Ringed(0));
  const std::vector<LineOnBoard> lines = LinesOf(world, 0, kLevelRing);
  ASSERT_GE(lines.size(), 5U);
  const auto start = LinearStart(lines);
  ASSERT_TRUE(start.has_value());
  EXPECT_THAT(*start, Rigid3Near(world.camera_from_lidar[0], 1e-6, 1e-6));
}

TEST(LinearStart, OfFourBoardsIsLoose) {
  const SolveWorld world(Ringed(0));
  std::vector<LineOnBoard> lines = LinesOf(world, 0, kLevelRing);
  ASSERT_GE(lines.size(), 4U);
  lines.resize(4);  // eight equations for nine unknowns
  EXPECT_FALSE(LinearStart(lines).has_value());
}

TEST(SolveLineScan, RecoversThePoseExactlyWithoutAGuess) {
  const SolveWorld world(Ringed(0));
  for (std::size_t c = 0; c < 2; ++c) {
    const CameraCalibration result = SolveCamera(world, c);
    EXPECT_EQ(result.status, SolveStatus::kConverged) << result.detail;
    EXPECT_THAT(result.camera_from_lidar, Rigid3Near(world.camera_from_lidar[c], 1e-7, 1e-7));
  }
}

TEST(SolveLineScan, OneLineAloneHasASay) {
  SolveWorld world(Ringed(1));
  const auto views = ViewsOf(world.rig.cameras[0], world.detections);
  const int line = LineThroughBoards(views.Used(), LineScanOptions{}.least_points);
  const Rigid3 with = SolveCamera(world, 0).camera_from_lidar;
  for (std::size_t v = 0; v < world.lidar_from_target.size(); ++v) {
    CloudEdges& cloud = world.CloudAt(v);
    cloud.raw_scatter.setZero();
    cloud.scatter.setZero();
    for (PointGroup& group : cloud.groups) {
      if (group.ring != line) group.scatter *= 3;
    }
  }
  EXPECT_THAT(SolveCamera(world, 0).camera_from_lidar, Rigid3Near(with, 0, 0));
}

TEST(SolveLineScan, ItsCovarianceIsTheUsualOne) {
  double chi2 = 0;
  constexpr int kSessions = 60;
  for (std::uint32_t seed = 0; seed < kSessions; ++seed) {
    SolveWorld world(Ringed(1, 20, 700 + seed));
    MakePlanesExact(&world);
    const CameraCalibration result = SolveCamera(world, 0);
    ASSERT_TRUE(result.covariance) << result.detail;
    chi2 += Chi2Of(world.camera_from_lidar[0], result.camera_from_lidar, *result.covariance) /
            kSessions;
  }
  // Of six degrees of freedom; 4 of its own sigma of sqrt(12 / 60), and noise along the normal.
  EXPECT_NEAR(chi2, 6, 1.8);
}

TEST(SolveLineScan, FewBoardsOnTheLineAreTooFew) {
  const SolveWorld world(Ringed(0, 4));
  const CameraCalibration result = SolveCamera(world, 0);
  EXPECT_EQ(result.status, SolveStatus::kNotSolved);
  EXPECT_THAT(result.detail, HasSubstr("5 are needed"));
}

TEST(SolveLineScan, BoardsThatAreElsewhereAreNoCalibration) {
  SolveWorld world(Ringed(0));
  for (std::size_t v = 0; v < world.lidar_from_target.size(); v += 2) {
    world.ImageAt(v, 0).pose->sensor_from_target.translation *= 1.3;
  }
  const CameraCalibration result = SolveCamera(world, 0);
  EXPECT_FALSE(result.converged());
  EXPECT_FALSE(result.covariance);
}

TEST(LinesOnBoard, AreTheRingsOnTheBoardAndNothingBehindIt) {
  const ScannedBoard scanned(BoardBefore(0.4, 0.2));
  const CloudEdges board = scanned.Detected();
  const auto lines = LinesOnBoard(scanned.cloud, board, scanned.target, 0.01);
  ASSERT_GT(lines.size(), 10U);
  const Eigen::Vector3d normal = board.normal;
  for (const PointGroup& line : lines) {
    const double points = line.scatter(3, 3);
    // All on the board's plane, to what single precision leaves of 7 m.
    const double off = normal.dot(line.scatter.topLeftCorner<3, 3>() * normal);
    EXPECT_LT(std::sqrt(std::abs(off) / points), 1e-5) << line.ring;
    const Eigen::Vector3d mean = board.centre + line.scatter.col(3).head<3>() / points;
    EXPECT_NEAR(std::atan2(mean.z(), mean.head<2>().norm()),
                ScannedBoard::kStepRad * (line.ring - 32), 0.01)
        << line.ring;
  }
}

TEST(CalibrateByLineScan, SolvesEachCameraByItself) {
  const SolveWorld world(Ringed(0));
  CalibrateOptions options;
  options.method = kLineScanMethod;
  const Report report = Calibrate(world.rig, world.detections, options);
  EXPECT_EQ(report.method, kLineScanMethod);
  for (std::size_t c = 0; c < 2; ++c) {
    const CameraReport& camera = report.cameras[c];
    EXPECT_TRUE(camera.calibration.converged()) << camera.calibration.StatusText();
    EXPECT_THAT(camera.calibration.camera_from_lidar,
                Rigid3Near(world.camera_from_lidar[c], 1e-7, 1e-7));
    // Views whose board the line does not cross are said to take no part.
    EXPECT_EQ(camera.used.size() + camera.rejected.size(), world.detections.size());
    EXPECT_FALSE(camera.rejected.empty());
  }
}

}  // namespace
}  // namespace rgbdt
