#include "calib/solve/internal/joint_solve.h"

#include "tests/unit/solve/joint_reports.h"

namespace rgbdt {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::Each;
using testing::ElementsAre;
using testing::Field;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

TEST(CalibrateJointly, FindsBothCamerasAndSaysHowSureItIs) {
  const SolveWorld world(Views(10));
  const Report report = Calibrate(world.rig, world.detections, Brief());
  for (std::size_t c = 0; c < 2; ++c) {
    const CameraReport& camera = report.cameras[c];
    EXPECT_EQ(camera.calibration.status, SolveStatus::kConverged);
    EXPECT_EQ(camera.used.size(), 10U);
    EXPECT_THAT(camera.rejected, IsEmpty());
    EXPECT_LT(Chi2(world, report, c), kMostChi2);
    ASSERT_TRUE(camera.sigma);
    EXPECT_LT(camera.sigma->centre_mm[0], 10);
  }
}

TEST(CalibrateJointly, ThreeViewsOfWhichOneIsHeldOutAreToldHowToBeUsed) {
  SolveWorldOptions options = Views(3);
  options.heldout_every = 3;
  const SolveWorld world(options);
  const Report report = Calibrate(world.rig, world.detections, Brief());
  EXPECT_THAT(report.cameras[0].calibration.detail,
              AllOf(HasSubstr("2 usable views, at least 3"), HasSubstr("1 more held out"),
                    HasSubstr("`heldout: false`")));
}

TEST(Evaluate, APoseThatNoViewAgreesWithIsRefusedAndItsInverseIsNamed) {
  const SolveWorld world(Views(6));
  Calibration calibration = Calibrate(world.rig, world.detections, Brief()).ToCalibration();
  const auto why = [&](const Rigid3& pose) {
    calibration.cameras[0].camera_from_lidar = pose;
    return Evaluate(world.rig, world.detections, calibration).cameras[0].contradiction;
  };
  const Rigid3 truth = world.camera_from_lidar[0];
  EXPECT_EQ(why(truth), "");
  EXPECT_THAT(why(truth.Inverse()), HasSubstr("In 6 the inverse does"));
  EXPECT_THAT(why({truth.rotation, 1000 * truth.translation}),
              AllOf(HasSubstr("In none of 6 views"), HasSubstr("in metres")));
}

// Between the sweep and the image.
void MoveBoard(const Eigen::Vector3d& move, CloudEdges* cloud) {
  cloud->pose->sensor_from_target.translation += move;
  cloud->centre += move;
  for (Crossing& crossing : cloud->crossings) crossing.point += move;
  for (Eigen::Vector3d& p : cloud->boundary) p += move;
}

TEST(CalibrateJointly, AViewWhoseBoardMovedIsRejectedByNameAndTheResultAsGoodAsWithoutIt) {
  SolveWorld world(Views(12));
  SolveWorld without(Views(12));
  without.detections.erase(without.detections.begin() + 4);
  MoveBoard(0.02 * (world.lidar_from_target[4].rotation * Eigen::Vector3d(1, 0, 0)),
            &world.CloudAt(4));
  const Report report = Calibrate(world.rig, world.detections, Brief());
  const Report good = Calibrate(without.rig, without.detections, Brief());
  for (std::size_t c = 0; c < 2; ++c) {
    EXPECT_THAT(report.cameras[c].rejected,
                ElementsAre(AllOf(Field(&RejectedView::view, "0005"),
                                  Field(&RejectedView::why, HasSubstr("contradicts the other")))));
    EXPECT_THAT(report.cameras[c].used, Not(Contains("0005")));
    EXPECT_THAT(report.cameras[c].calibration.camera_from_lidar,
                Rigid3Near(good.cameras[c].calibration.camera_from_lidar, 1e-6, 1e-6));
    EXPECT_LT(Chi2(world, report, c), kMostChi2);
  }
}

// Of few views one that is far off draws the result along, so that all others contradict it, too.
TEST(CalibrateJointly, AViewThatIsFarOffDoesNotHideBehindTheOthers) {
  for (std::uint32_t seed = 1; seed <= 6; ++seed) {
    SolveWorldOptions options = Views(6);
    options.seed = seed;
    SolveWorld world(options);
    MoveBoard({0, 0.1, 0}, &world.CloudAt(3));
    const Report report = Calibrate(world.rig, world.detections, Brief());
    for (std::size_t c = 0; c < 2; ++c) {
      EXPECT_THAT(report.cameras[c].rejected, ElementsAre(Field(&RejectedView::view, "0004")))
          << seed;
      EXPECT_LT(Chi2(world, report, c), kMostChi2) << seed;
    }
  }
}

TEST(CalibrateJointly, ASideWithSomethingAgainstItIsLeftOutByNameAndTheViewIsUsed) {
  SolveWorld world(Views(12));
  const SolveWorld clean(Views(12));
  const Eigen::Vector3d right = world.lidar_from_target[4].rotation * Eigen::Vector3d(1, 0, 0);
  CloudEdges& cloud = world.CloudAt(4);
  ASSERT_THAT(cloud.pose->sensor_from_target, Rigid3Near(world.lidar_from_target[4], 0.1, 0.1));
  for (Crossing& crossing : cloud.crossings) {
    if (crossing.side == 1) crossing.point += 0.010 * right;
  }
  const Report report = Calibrate(world.rig, world.detections, Brief());
  const Report good = Calibrate(clean.rig, clean.detections, Brief());
  for (std::size_t c = 0; c < 2; ++c) {
    const CameraReport& camera = report.cameras[c];
    EXPECT_THAT(camera.rejected, IsEmpty());
    EXPECT_THAT(camera.warnings, ElementsAre(AllOf(HasSubstr("view 0005: the board's right side"),
                                                   HasSubstr("the view is used"))));
    EXPECT_THAT(camera.used, Contains("0005"));
    EXPECT_LT(Chi2(world, report, c), kMostChi2);
    EXPECT_LT(Chi2Of(good.cameras[c].calibration.camera_from_lidar,
                     camera.calibration.camera_from_lidar, *camera.calibration.covariance),
              3);
  }
}

// Two views of which only the right half is seen, by a person's picks.
SolveWorld HalfHidden(int views) {
  SolveWorld world(Views(views));
  for (const std::size_t view : {2U, 7U}) {
    for (std::size_t c = 0; c < 2; ++c) {
      ImageEdges& image = world.ImageAt(view, c);
      image.picked = true;
      for (std::size_t i = 0; i < image.corners.size(); ++i) {
        if (i % 8 < 4) image.corners[i] = UnseenCorner();  // of eight in a row
      }
      image.sides[3] = {};
    }
  }
  return world;
}

TEST(CalibrateJointly, ViewsOfWhichAPartIsHiddenTellWhatWasSeenOfThem) {
  SolveWorld hidden = HalfHidden(10);
  const SolveWorld whole(Views(10));
  SolveWorld without(Views(10));
  without.detections.erase(without.detections.begin() + 7);
  without.detections.erase(without.detections.begin() + 2);
  const Report report = Calibrate(hidden.rig, hidden.detections, Brief());
  const Report more = Calibrate(whole.rig, whole.detections, Brief());
  const Report less = Calibrate(without.rig, without.detections, Brief());
  for (std::size_t c = 0; c < 2; ++c) {
    const CameraReport& camera = report.cameras[c];
    EXPECT_THAT(camera.rejected, IsEmpty());
    EXPECT_THAT(camera.used, AllOf(Contains("0003"), Contains("0008")));
    ASSERT_TRUE(camera.calibration.covariance);
    EXPECT_LT(Chi2(hidden, report, c), kMostChi2);
    // What they tell lies between nothing and all.
    const auto sigma = [&](const Report& r) {
      return std::sqrt(r.cameras[c].calibration.covariance->diagonal().head<3>().sum());
    };
    EXPECT_GT(sigma(report), sigma(more));
    EXPECT_LT(sigma(report), sigma(less));
  }
}

TEST(CalibrateJointly, AViewOfWhichOneImageFailedServesTheOtherCamera) {
  SolveWorld world(Views(8));
  ImageDetection& failed = world.detections[3].images[1];
  failed.edges.reset();
  failed.why_not = "no checkerboard";
  const Report report = Calibrate(world.rig, world.detections, Brief());
  EXPECT_THAT(report.cameras[0].rejected, IsEmpty());
  EXPECT_EQ(report.cameras[0].used.size(), 8U);
  EXPECT_EQ(report.cameras[1].used.size(), 7U);
  EXPECT_THAT(report.cameras[1].rejected,
              ElementsAre(AllOf(Field(&RejectedView::view, "0004"),
                                Field(&RejectedView::why, "no checkerboard"))));
  ASSERT_EQ(report.detections.size(), 8U);
  EXPECT_EQ(report.detections[3].images[0].why_not, "");
  EXPECT_EQ(report.detections[3].images[1].why_not, "no checkerboard");
  EXPECT_EQ(report.detections[3].cloud_candidates, 1);
  for (std::size_t c = 0; c < 2; ++c) EXPECT_LT(Chi2(world, report, c), kMostChi2);
}

TEST(CalibrateJointly, CamerasMayTellTheBoardFromOppositeEnds) {
  const SolveWorld world(Views(10));
  SolveWorld turned(Views(10));
  for (std::size_t v = 0; v < 10; ++v) TurnImage(&turned.ImageAt(v, 1));
  const Report a = Calibrate(world.rig, world.detections, Brief());
  const Report b = Calibrate(turned.rig, turned.detections, Brief());
  for (std::size_t c = 0; c < 2; ++c) {
    EXPECT_THAT(b.cameras[c].calibration.camera_from_lidar,
                Rigid3Near(a.cameras[c].calibration.camera_from_lidar, 1e-8, 1e-8));
  }
}

TEST(MakeJointProblem, TheBoardsAreToldAsTheCameraThatKnowsItsTopTellsThem) {
  SolveWorld world(Views(6));
  for (std::size_t v = 0; v < 6; ++v) {
    world.ImageAt(v, 0).pose->half_turn_known = false;
    TurnImage(&world.ImageAt(v, 0));
  }
  const SolveSession session(world);
  const JointProblem joint = session.Joint();
  ASSERT_EQ(joint.problem.views.size(), 6U);
  for (std::size_t v = 0; v < 6; ++v) {
    const BoardView& view = joint.problem.views[v];
    EXPECT_THAT(view.cloud.pose->sensor_from_target,
                Rigid3Near(world.lidar_from_target[v], 0.1, 0.1));
    EXPECT_TRUE(view.images[0].turned);
    EXPECT_FALSE(view.images[1].turned);
    for (const Crossing& crossing : view.cloud.crossings) {
      const CrossingResidual r = ResidualOf(world.rig.target, {}, crossing,
                                            world.lidar_from_target[v], joint.start.shared, 0);
      EXPECT_LT(std::abs(r.beyond_m), 0.02);
    }
  }
}

// A second board that nobody declared, likelier by itself, here and there about the target.
// One more candidate in each cloud, likelier by itself, so far aside.
void AddSecondBoards(double aside, double further, SolveWorld* world,
                     const Eigen::Vector3d& way = Eigen::Vector3d::UnitY()) {
  double by = aside;
  for (ViewDetection& detection : world->detections) {
    CloudEdges other = detection.cloud.candidates.at(0);
    const Rigid3 moved{Eigen::Quaterniond::Identity(), by * way};
    other.pose->sensor_from_target = moved * other.pose->sensor_from_target;
    other.centre = moved * other.centre;
    for (Crossing& crossing : other.crossings) crossing.point = moved * crossing.point;
    for (Eigen::Vector3d& point : other.boundary) point = moved * point;
    detection.cloud.candidates.insert(detection.cloud.candidates.begin(), other);
    by = by > 1.5 * aside ? aside : by + further;
  }
}

TEST(CalibrateJointly, ASecondBoardElsewhereIsNeitherUsedNorSpokenOf) {
  SolveWorld world(Views(8));
  const Report alone = Calibrate(world.rig, world.detections, Brief());
  AddSecondBoards(1, 0.13, &world);
  const Report report = Calibrate(world.rig, world.detections, Brief());
  for (std::size_t c = 0; c < 2; ++c) {
    const CameraReport& camera = report.cameras[c];
    EXPECT_THAT(alone.cameras[c].warnings, IsEmpty());
    EXPECT_THAT(camera.warnings, IsEmpty());
    EXPECT_THAT(camera.calibration.camera_from_lidar,
                Rigid3Near(alone.cameras[c].calibration.camera_from_lidar, 1e-9, 1e-9));
  }
}

TEST(CalibrateJointly, ASecondBoardThatCouldBeTheTargetIsNamed) {
  SolveWorld world(Views(8));
  AddSecondBoards(0.08, 0.02, &world, Eigen::Vector3d::UnitX());  // behind it
  const Report report = Calibrate(world.rig, world.detections, Brief());
  for (const CameraReport& camera : report.cameras) {
    EXPECT_THAT(
        camera.warnings,
        Contains(AllOf(HasSubstr("two boards of the target's size"), HasSubstr("of 8 clouds"),
                       HasSubstr("the target at"), HasSubstr("the other at"))));
  }
}

// Two boards cannot be in one place.
TEST(CalibrateJointly, ABoardThatFitsInTwoPlacesOfOneSurfaceMayBeLarger) {
  SolveWorld world(Views(8));
  AddSecondBoards(0.04, 0.005, &world);
  const Report report = Calibrate(world.rig, world.detections, Brief());
  for (const CameraReport& camera : report.cameras) {
    EXPECT_THAT(camera.warnings,
                Contains(AllOf(HasSubstr("fits in two places of one surface in"),
                               HasSubstr("of 8 clouds"), HasSubstr("Is it larger than given?"))));
    EXPECT_THAT(camera.warnings, Each(Not(HasSubstr("two boards"))));
  }
}

TEST(MakeJointProblem, ACameraThatTakesAnotherBoardOfTheCloudIsRejected) {
  SolveWorld world(Views(6));
  SolveSession session(world);
  session.cameras[1].views.all[2].cloud->centre += Eigen::Vector3d(0, 0.5, 0);
  const JointProblem joint = session.Joint();
  EXPECT_EQ(joint.problem.views[2].images.size(), 1U);
  EXPECT_THAT(joint.cameras[1].views.all[2].rejected, HasSubstr("another board of the cloud"));
}

TEST(CalibrateApart, GivesEachCameraWhatItWouldHaveAlone) {
  const SolveWorld world(Views(10));
  CalibrateOptions apart = Brief();
  apart.joint = false;
  const Report report = Calibrate(world.rig, world.detections, apart);
  const Report together = Calibrate(world.rig, world.detections, Brief());
  for (std::size_t c = 0; c < 2; ++c) {
    Rig alone = world.rig;
    alone.cameras = {world.rig.cameras[c]};
    const Report one = Calibrate(alone, world.detections, Brief());
    EXPECT_THAT(report.cameras[c].calibration.camera_from_lidar,
                Rigid3Near(one.cameras[0].calibration.camera_from_lidar, 1e-12, 1e-12));
    EXPECT_LT(Chi2(world, report, c), kMostChi2);
    // Together they differ, if little.
    const Rigid3& joint = together.cameras[c].calibration.camera_from_lidar;
    EXPECT_THAT(report.cameras[c].calibration.camera_from_lidar,
                AllOf(Rigid3Near(joint, 0.005, 0.015), Not(Rigid3Near(joint, 1e-7, 1e-7))));
  }
}

TEST(CalibrateJointly, TheOrderOfTheDetectionsDoesNotMatter) {
  const SolveWorld world(Views(8));
  std::vector<ViewDetection> shuffled(world.detections.rbegin(), world.detections.rend());
  std::swap(shuffled[1], shuffled[5]);
  std::swap(shuffled[3].images[0], shuffled[3].images[1]);
  const Report a = Calibrate(world.rig, world.detections, Brief());
  const Report b = Calibrate(world.rig, shuffled, Brief());
  for (std::size_t c = 0; c < 2; ++c) {
    EXPECT_EQ(a.cameras[c].calibration.camera_from_lidar.translation,
              b.cameras[c].calibration.camera_from_lidar.translation);
    EXPECT_EQ(*a.cameras[c].calibration.covariance, *b.cameras[c].calibration.covariance);
    EXPECT_EQ(a.cameras[c].used, b.cameras[c].used);
  }
}

TEST(SolveJointly, ViewsThatScatterMoreThanTheyStateEnlargeTheCovariance) {
  SolveWorldOptions options = Views(12);
  const SolveWorld honest(options);
  options.noise = 2.5;
  const SolveWorld noisy(options);
  const SolveSession honest_session(honest);
  const SolveSession noisy_session(noisy);
  // What is to be expected of the factor is a little more than 1 where views scatter as they state.
  const JointResult as_stated = SolveJointly(honest_session.Joint());
  EXPECT_GE(as_stated.variance_factor, 1);
  EXPECT_LT(as_stated.variance_factor, 1.3);
  const JointResult enlarged = SolveJointly(noisy_session.Joint());
  EXPECT_GT(enlarged.variance_factor, 2.5 * 2.5 / 2);
  EXPECT_LT(enlarged.variance_factor, 2.5 * 2.5 * 2);
  EXPECT_NEAR(CovarianceOf(enlarged, 1)(3, 3),
              enlarged.variance_factor * enlarged.solution.covariance(9, 9), 1e-12);
}

}  // namespace
}  // namespace rgbdt
