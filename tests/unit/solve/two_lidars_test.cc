#include <cmath>

#include "calib/solve/by_boards.h"
#include "calib/solve/internal/further_lidars.h"
#include "calib/solve/internal/swap_reference.h"
#include "calib/solve/internal/view_equations.h"
#include "tests/unit/solve/joint_reports.h"

namespace rgbdt {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::Field;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

// Half a metre away, looking elsewhere.
Rigid3 ReferenceFromLidar() {
  Rigid3 pose = RotationAbout({0.2, -0.3, 0.9}, 0.7);
  pose.translation = {-0.3, 0.35, 0.2};
  return pose;
}

// A session's world and what a second LIDAR sees of it.
struct TwoLidars {
  SolveWorld world;
  LidarViews second;

  explicit TwoLidars(const SolveWorldOptions& options, double ranges_off_m = 0)
      : world(options), second(world.SeenBy("rear", ReferenceFromLidar(), ranges_off_m)) {}

  CalibratedCameras Solve(std::vector<LidarViews> lidars) const {
    CalibrateOptions options = Brief();
    options.first_guess.range_offset_sigma_m = world.rig.lidar.range_offset_sigma_m;
    std::vector<CameraViews> cameras;
    for (const CameraSpec& camera : world.rig.cameras) {
      cameras.push_back(ViewsOf(camera, world.detections));
    }
    return CalibrateWithLidars(world.rig.target, options, std::move(cameras), std::move(lidars));
  }
  CalibratedCameras Solve() const { return Solve({second}); }

  JointProblem Joint() const {
    JointProblem joint = SolveSession(world).Joint(0.02);
    AddLidars({second}, 3, 0.02, &joint);
    return joint;
  }

  // Of a camera's pose, by its own covariance.
  double Chi2Of(const CalibratedCameras& found, std::size_t camera) const {
    const CameraCalibration& c = found.cameras[camera].report.calibration;
    return rgbdt::Chi2Of(world.camera_from_lidar[camera], c.camera_from_lidar, *c.covariance);
  }
};

// Of the second LIDAR's pose, by its own covariance.
double Chi2(const LidarCalibration& found) {
  return rgbdt::Chi2Of(ReferenceFromLidar(), found.reference_from_lidar, *found.covariance);
}

TEST(TwoLidars, ThePoseIsFoundAndItsErrorIsWhatItsCovarianceSays) {
  constexpr int kWorlds = 20;
  double sum = 0;
  for (int seed = 1; seed <= kWorlds; ++seed) {
    SolveWorldOptions options;
    options.seed = static_cast<std::uint32_t>(seed);
    options.draw_nuisances = true;
    options.side_sigma_rad = BoardPriors().side_sigma_rad;
    const CalibratedCameras found = TwoLidars(options, 0.01).Solve();
    ASSERT_EQ(found.lidars.size(), 1U);
    const LidarReport& lidar = found.lidars[0];
    ASSERT_EQ(lidar.calibration.status, SolveStatus::kConverged) << lidar.calibration.detail;
    EXPECT_EQ(lidar.calibration.lidar, "rear");
    EXPECT_EQ(lidar.used.size(), 10U);
    EXPECT_THAT(lidar.rejected, IsEmpty());
    EXPECT_LT(Chi2(lidar.calibration), kMostChi2);
    ASSERT_TRUE(lidar.sigma);
    sum += Chi2(lidar.calibration);
  }
  // 120 squares of unit normals: their mean is known to a seventh.
  EXPECT_GT(sum / kWorlds / 6, 0.5);
  EXPECT_LT(sum / kWorlds / 6, 1.5);
}

TEST(TwoLidars, CamerasAreKnownBetterByTwoThanByOne) {
  const TwoLidars session(Views(8));
  const CalibratedCameras by_two = session.Solve();
  const CalibratedCameras by_one = session.Solve({});
  EXPECT_THAT(by_one.lidars, IsEmpty());
  for (std::size_t c = 0; c < 2; ++c) {
    EXPECT_LT(session.Chi2Of(by_two, c), kMostChi2);
    EXPECT_LT(by_two.cameras[c].report.sigma->rotation_deg[0],
              by_one.cameras[c].report.sigma->rotation_deg[0]);
  }
}

TEST(TwoLidars, WhichOfThemIsTheReferenceDoesNotMatter) {
  const TwoLidars session(Views(6), 0.01);
  const JointProblem joint = session.Joint();
  BoardProblem problem = joint.problem;
  BoardState start = joint.start;
  const BoardSolution solution = SolveBoards(problem, start, 1e-12);
  SwapReference(0, &problem, &start);
  const BoardSolution swapped = SolveBoards(problem, start, 1e-12);
  EXPECT_THAT(swapped.state.lidars[0].reference_from_lidar.Inverse(),
              Rigid3Near(solution.state.lidars[0].reference_from_lidar, 1e-7, 1e-7));
  for (std::size_t c = 0; c < 2; ++c) {
    EXPECT_THAT(swapped.state.camera_from_lidar[c],
                Rigid3Near(solution.state.camera_from_lidar[c] *
                               solution.state.lidars[0].reference_from_lidar,
                           1e-7, 1e-7));
  }
  SwapReference(0, &problem, &start);
  EXPECT_THAT(start.lidars[0].reference_from_lidar,
              Rigid3Near(joint.start.lidars[0].reference_from_lidar, 1e-12, 1e-12));
}

// The second LIDAR's sides of a view at their best, all else as it is.
BoardState WithSidesSettled(const BoardProblem& problem, BoardState state, std::size_t view) {
  const Eigen::VectorXd still = Eigen::VectorXd::Zero(kOwnUnknowns + SharedPlaces(problem).Count());
  for (int i = 0; i < 30; ++i) {  // robust weights settle, too
    const ViewEquations equations(problem, state, view);
    const Eigen::Vector4d step = equations.further()[0].SideStep(still);
    for (int side = 0; side < 4; ++side) {
      state.lidars[0].side_shift[view][static_cast<std::size_t>(side)] += step[side];
    }
  }
  return state;
}

// Where sides are at their best, those that are eliminated have no gradient left: what remains is
// the derivative with the sides as they are.
TEST(TwoLidars, TheGradientByThePoseIsTheCostsDerivative) {
  const TwoLidars session(Views(4));
  const JointProblem joint = session.Joint();
  const SharedPlaces places(joint.problem);
  constexpr double kStep = 1e-6;
  for (std::size_t view = 0; view < joint.problem.views.size(); ++view) {
    const BoardState here = WithSidesSettled(joint.problem, joint.start, view);
    const auto cost = [&](const Vector6d& delta) {
      BoardState state = here;
      Rigid3& pose = state.lidars[0].reference_from_lidar;
      pose = Exp(delta) * pose;
      return ViewEquations(joint.problem, state, view).cost();
    };
    const ViewEquations equations(joint.problem, here, view);
    for (int i = 0; i < 6; ++i) {
      const Vector6d delta = kStep * Vector6d::Unit(i);
      const double slope = (cost(delta) - cost(-delta)) / (2 * kStep);
      const Eigen::Index at = kOwnUnknowns + places.LidarPose(0) + i;
      const double scale = std::sqrt(equations.h()(at, at));
      EXPECT_NEAR(-2 * equations.g()[at] / scale, slope / scale, 2e-3)
          << "view " << view << ", delta " << i;
    }
  }
}

TEST(TwoLidars, AViewInWhichItsBoardMovedIsRejectedByNameAndTheOthersAreUsed) {
  TwoLidars session(Views(12));
  CloudEdges& cloud = session.second.candidates["0005"][0];
  const Eigen::Vector3d move =
      0.03 * (cloud.pose->sensor_from_target.rotation * Eigen::Vector3d(1, 0, 0));
  cloud.pose->sensor_from_target.translation += move;
  cloud.centre += move;
  for (Crossing& crossing : cloud.crossings) crossing.point += move;
  const CalibratedCameras found = session.Solve();
  EXPECT_THAT(found.lidars[0].rejected,
              ElementsAre(AllOf(Field(&RejectedView::view, "0005"),
                                Field(&RejectedView::why, HasSubstr("contradicts the other")))));
  EXPECT_THAT(found.lidars[0].used, Not(Contains("0005")));
  EXPECT_LT(Chi2(found.lidars[0].calibration), kMostChi2);
  for (const CameraViews& camera : found.cameras) EXPECT_NE(camera.Find("0005"), nullptr);
}

TEST(TwoLidars, AViewWithoutItsBoardIsNoViewOfIt) {
  TwoLidars session(Views(8));
  session.second.candidates.erase("0003");
  CloudDetection none;
  none.why_not = "no board found";
  session.second.Add("0003", none);
  const CalibratedCameras found = session.Solve();
  EXPECT_THAT(found.lidars[0].rejected,
              ElementsAre(AllOf(Field(&RejectedView::view, "0003"),
                                Field(&RejectedView::why, "no board found"))));
  EXPECT_EQ(found.lidars[0].used.size(), 7U);
  EXPECT_LT(Chi2(found.lidars[0].calibration), kMostChi2);
}

TEST(TwoLidars, TooFewViewsAreSaidSoAndTheCamerasAreCalibratedAllTheSame) {
  TwoLidars session(Views(6));
  for (const char* view : {"0001", "0002", "0003", "0004"}) session.second.candidates.erase(view);
  const CalibratedCameras found = session.Solve();
  EXPECT_EQ(found.lidars[0].calibration.status, SolveStatus::kNotSolved);
  EXPECT_THAT(found.lidars[0].calibration.detail, HasSubstr("2 views in which this LIDAR"));
  for (std::size_t c = 0; c < 2; ++c) EXPECT_LT(session.Chi2Of(found, c), kMostChi2);
}

TEST(TwoLidars, WhichOfASquaresTurnsItIsIsToldByTheViewsTogether) {
  SolveWorldOptions options;
  options.plain = true;
  const CalibratedCameras found = TwoLidars(options).Solve();
  ASSERT_EQ(found.lidars[0].calibration.status, SolveStatus::kConverged);
  EXPECT_EQ(found.lidars[0].used.size(), 10U);
  EXPECT_LT(Chi2(found.lidars[0].calibration), kMostChi2);
}

// By a plain board the reference's offset is no unknown: what is common to both stays with the
// cameras, their difference does not go into the pose.
TEST(TwoLidars, RangesThatDifferBetweenTheTwoAreToldByAPlainBoard) {
  SolveWorldOptions options;
  options.plain = true;
  const CalibratedCameras found = TwoLidars(options, 0.015).Solve();
  ASSERT_EQ(found.lidars[0].calibration.status, SolveStatus::kConverged);
  EXPECT_LT(Chi2(found.lidars[0].calibration), kMostChi2);
}

TEST(TwoLidars, ARangeOffsetThatTheViewsRefuteIsFreedAndSaid) {
  TwoLidars session(Views(10), 0.03);
  session.second.range_offset_sigma_m = 0.002;
  const CalibratedCameras found = session.Solve();
  ASSERT_EQ(found.lidars[0].calibration.status, SolveStatus::kConverged);
  EXPECT_THAT(found.lidars[0].warnings, Contains(HasSubstr("the LIDAR's ranges are")));
  EXPECT_LT(Chi2(found.lidars[0].calibration), kMostChi2);
}

TEST(TwoLidars, WhereTooFewCloudsAreLeftToTellWhichIsWrongThePoseIsNotToBeUsed) {
  TwoLidars session(Views(10));
  for (const char* view : {"0001", "0002", "0003", "0004", "0005", "0006", "0007"}) {
    session.second.candidates.erase(view);
  }
  CloudEdges& cloud = session.second.candidates["0009"][0];
  const Eigen::Vector3d move(0.1, 0.05, 0.1);
  cloud.pose->sensor_from_target.translation += move;
  cloud.centre += move;
  for (Crossing& crossing : cloud.crossings) crossing.point += move;
  const CalibratedCameras found = session.Solve();
  EXPECT_FALSE(found.lidars[0].calibration.converged());
  EXPECT_NE(found.lidars[0].calibration.detail, "");
  for (std::size_t c = 0; c < 2; ++c) EXPECT_LT(session.Chi2Of(found, c), kMostChi2);
}

TEST(TwoLidars, CloudsOfAnotherScaleAreNotTakenForAPose) {
  TwoLidars session(Views(10));
  for (auto& [view, candidates] : session.second.candidates) {
    for (CloudEdges& cloud : candidates) {
      cloud.pose->sensor_from_target.translation *= 1.05;
      cloud.centre *= 1.05;
      for (Crossing& crossing : cloud.crossings) crossing.point *= 1.05;
    }
  }
  const CalibratedCameras found = session.Solve();
  const LidarCalibration& lidar = found.lidars[0].calibration;
  EXPECT_EQ(lidar.status, SolveStatus::kContradicted);
  EXPECT_THAT(lidar.detail, HasSubstr("% farther from each other than the reference"));
  for (std::size_t c = 0; c < 2; ++c) EXPECT_LT(session.Chi2Of(found, c), kMostChi2);
}

}  // namespace
}  // namespace rgbdt
