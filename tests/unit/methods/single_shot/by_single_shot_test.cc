#include "calib/methods/single_shot/by_single_shot.h"

#include <algorithm>
#include <cmath>

#include "calib/methods/calibrate.h"
#include "calib/methods/single_shot/planar_patches.h"
#include "tests/unit/methods/scanned_board.h"
#include "tests/unit/solve/solve_world.h"

namespace rgbdt {
namespace {

using testing::HasSubstr;

// A piece of a plane somewhere about, as large as a board.
CloudEdges Clutter(Random* random) {
  CloudEdges piece;
  piece.centre = {random->Uniform(1.5, 5), random->Uniform(-3, 3), random->Uniform(-1, 1)};
  piece.normal = random->Direction();
  if (piece.normal.dot(piece.centre) > 0) piece.normal = -piece.normal;
  piece.points = 200;
  Eigen::Matrix4d scatter = Eigen::Matrix4d::Zero();
  scatter.topLeftCorner<3, 3>() =
      10 * (Eigen::Matrix3d::Identity() - piece.normal * piece.normal.transpose());
  scatter(3, 3) = piece.points;
  piece.scatter = scatter;
  piece.raw_scatter = scatter;
  piece.boundary = {piece.centre};
  return piece;
}

// Candidates as PlanarPatches gives them: no pose, the board among others, in any order.
void MakePatches(int clutter, SolveWorld* world) {
  Random random(77);
  for (std::size_t v = 0; v < world->detections.size(); ++v) {
    auto& candidates = world->detections[v].cloud.candidates;
    candidates[0].pose.reset();
    candidates[0].crossings.clear();
    for (int i = 0; i < clutter; ++i) candidates.push_back(Clutter(&random));
    std::rotate(candidates.begin(), candidates.begin() + static_cast<std::ptrdiff_t>(v) % clutter,
                candidates.end());
  }
}

SolveWorldOptions World(double noise) {
  SolveWorldOptions options;
  options.noise = noise;
  options.views = 8;
  return options;
}

std::vector<FlatPiece> BoardsOf(const SolveWorld& world) {
  std::vector<FlatPiece> boards;
  for (const Rigid3& board : world.lidar_from_target) {
    const Rigid3 seen = world.camera_from_lidar[0] * board;
    boards.push_back({seen.translation, -(seen.rotation * Eigen::Vector3d::UnitZ())});
  }
  return boards;
}

TEST(PoseOfTriple, LaysPiecesOnBoards) {
  const SolveWorld world(World(0));
  const std::vector<FlatPiece> boards = BoardsOf(world);
  const Rigid3 lidar_from_camera = world.camera_from_lidar[0].Inverse();
  FlatPiece pieces[3];
  for (std::size_t i = 0; i < 3; ++i) {
    pieces[i] = {lidar_from_camera * boards[i].centre,
                 lidar_from_camera.rotation * boards[i].normal};
  }
  EXPECT_THAT(PoseOfTriple({boards[0], boards[1], boards[2]}, pieces),
              Rigid3Near(world.camera_from_lidar[0], 1e-9, 1e-9));
}

TEST(MatchPlanes, FindsWhichPieceIsWhichBoard) {
  const SolveWorld world(World(0));
  const std::vector<FlatPiece> boards = BoardsOf(world);
  const Rigid3 lidar_from_camera = world.camera_from_lidar[0].Inverse();
  Random random(3);
  std::vector<FlatPiece> pieces;
  for (int i = 0; i < 40; ++i) {
    const CloudEdges clutter = Clutter(&random);
    pieces.push_back({clutter.centre, clutter.normal});
  }
  for (auto board = boards.rbegin(); board != boards.rend(); ++board) {
    pieces.push_back(
        {lidar_from_camera * board->centre, lidar_from_camera.rotation * board->normal});
  }
  const std::vector<PlaneMatch> matches = MatchPlanes(boards, pieces);
  ASSERT_FALSE(matches.empty());
  EXPECT_THAT(matches[0].camera_from_lidar, Rigid3Near(world.camera_from_lidar[0], 1e-6, 1e-6));
  for (std::size_t b = 0; b < boards.size(); ++b) {
    EXPECT_EQ(matches[0].piece[b], static_cast<int>(40 + boards.size() - 1 - b));
  }
}

TEST(SolveSingleShot, RecoversThePoseExactlyAmongClutter) {
  SolveWorld world(World(0));
  MakePatches(6, &world);
  for (std::size_t c = 0; c < 2; ++c) {
    CameraViews views = ViewsOf(world.rig.cameras[c], world.detections);
    const CameraCalibration result = SolveSingleShot(&views, 3);
    EXPECT_EQ(result.status, SolveStatus::kConverged) << result.detail;
    EXPECT_THAT(result.camera_from_lidar, Rigid3Near(world.camera_from_lidar[c], 1e-7, 1e-7));
    EXPECT_EQ(views.Used().size(), 8U);
  }
}

TEST(SolveSingleShot, WithoutTheBoardsInTheCloudsThereIsNoPose) {
  SolveWorld world(World(0));
  MakePatches(6, &world);
  Random random(8);
  for (std::size_t v = 0; v < 8; ++v) {
    auto& candidates = world.detections[v].cloud.candidates;
    for (CloudEdges& candidate : candidates) candidate = Clutter(&random);
  }
  CameraViews views = ViewsOf(world.rig.cameras[0], world.detections);
  const CameraCalibration result = SolveSingleShot(&views, 3);
  EXPECT_FALSE(result.converged());
  EXPECT_THAT(result.detail, HasSubstr("boards"));
}

TEST(SolveSingleShot, SaysWhereTwoPosesFitAlike) {
  SolveWorld world(World(0));
  MakePatches(2, &world);
  // Everything stands there twice, once turned about the LIDAR.
  const Rigid3 turn = RotationAbout({0, 0, 1}, 1.2);
  for (ViewDetection& view : world.detections) {
    const std::vector<CloudEdges> once = view.cloud.candidates;
    for (CloudEdges piece : once) {
      Eigen::Matrix4d to_turned = Eigen::Matrix4d::Identity();
      to_turned.topLeftCorner<3, 3>() = turn.rotation.toRotationMatrix();
      piece.centre = turn * piece.centre;
      piece.normal = turn.rotation * piece.normal;
      piece.raw_scatter = to_turned * piece.raw_scatter * to_turned.transpose();
      view.cloud.candidates.push_back(piece);
    }
  }
  CameraViews views = ViewsOf(world.rig.cameras[0], world.detections);
  const CameraCalibration result = SolveSingleShot(&views, 3);
  EXPECT_EQ(result.status, SolveStatus::kUndetermined);
  EXPECT_THAT(result.detail, HasSubstr("two poses fit alike"));
}

TEST(CalibrateBySingleShot, JudgesWhatItFinds) {
  SolveWorld world(World(1));
  MakePatches(6, &world);
  CalibrateOptions options;
  options.method = kSingleShotMethod;
  const Report report = Calibrate(world.rig, world.detections, options);
  for (std::size_t c = 0; c < 2; ++c) {
    const CameraReport& camera = report.cameras[c];
    EXPECT_TRUE(camera.calibration.converged()) << camera.calibration.StatusText();
    // As `plane` from the same points: by_planes_test.cc.
    EXPECT_THAT(camera.calibration.camera_from_lidar,
                Rigid3Near(world.camera_from_lidar[c], 0.01, 0.03));
    EXPECT_EQ(camera.used.size(), 8U);
    EXPECT_TRUE(camera.sigma);
  }
}

TEST(PlanarPatches, AreAsLargeAsTheBoard) {
  const ScannedBoard scanned(BoardBefore(0.3, 0.2));
  const auto patches = PlanarPatches(scanned.cloud, scanned.target);
  ASSERT_EQ(patches.size(), 1U);  // the wall is too large
  const CloudEdges board = scanned.Detected();
  // Its outermost beams lie up to a spacing inside of each side.
  EXPECT_THAT(patches[0].centre, EigenNear(board.centre, board.spacing_m));
  EXPECT_GT(patches[0].normal.dot(board.normal), std::cos(1e-3));
  EXPECT_FALSE(patches[0].pose);
  EXPECT_EQ(patches[0].raw_scatter(3, 3), patches[0].points);
}

}  // namespace
}  // namespace rgbdt
