#include "calib/methods/calibrate_sessions.h"
#include "calib/model/errors.h"
#include "tests/unit/solve/joint_reports.h"

namespace rgbdt {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

// Two sessions of a rig whose lenses nobody has measured, cameras moved in between.
struct TwoSessions {
  explicit TwoSessions(std::uint32_t seed, double angle = 0.01, double distance_m = 0.01)
      : world(Options(seed)) {
    sessions.push_back({"monday", world.detections});
    before = world.camera_from_lidar;
    world.MoveCameras(angle, distance_m);
    after = world.camera_from_lidar;
    while (world.detections.size() < 16) world.AddView(world.AnyBoard());
    sessions.push_back({"friday", {world.detections.begin() + 8, world.detections.end()}});
  }

  static SolveWorldOptions Options(std::uint32_t seed) {
    SolveWorldOptions options = Views(8);
    options.seed = seed;
    options.lens_uncertainty.reset();
    return options;
  }

  // The truth of how far a camera moved, against what was found; by its own sigmas.
  double Chi2OfChange(const PoseComparison& moved, std::size_t camera) const {
    const Vector6d truth = Log(after[camera] * before[camera].Inverse());
    double chi2 = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Estimate& turned = moved.rotation_deg[k];
      const double off = turned.value - truth[static_cast<Eigen::Index>(k)] * 180 / M_PI;
      chi2 += off * off / (turned.sigma * turned.sigma) / 3;
    }
    return chi2;
  }

  SolveWorld world;
  std::vector<SessionViews> sessions;
  std::vector<Rigid3> before, after;
};

TEST(CalibrateSessions, EachHasItsOwnPosesAndAllHaveOneLens) {
  const TwoSessions two(3);
  const CalibratedSessions found = CalibrateSessions(two.world.rig, two.sessions, Brief());
  ASSERT_THAT(found.reports, SizeIs(2));
  for (std::size_t c = 0; c < 2; ++c) {
    const CameraCalibration& monday = found.reports[0].cameras[c].calibration;
    const CameraCalibration& friday = found.reports[1].cameras[c].calibration;
    EXPECT_LT(Chi2Of(two.before[c], monday.camera_from_lidar, *monday.covariance), kMostChi2);
    EXPECT_LT(Chi2Of(two.after[c], friday.camera_from_lidar, *friday.covariance), kMostChi2);
    EXPECT_EQ(NumbersOf(monday.lens->lens), NumbersOf(friday.lens->lens));
    // What two sessions tell of a lens is more than one does.
    const Report alone = Calibrate(two.world.rig, two.sessions[0].detections, Brief());
    EXPECT_LT(monday.lens->covariance(2, 8),
              0.8 * alone.cameras[c].calibration.lens->covariance(2, 8));
  }
  ASSERT_THAT(found.comparisons, SizeIs(1));
  EXPECT_EQ(found.comparisons[0].a, "monday");
  EXPECT_EQ(found.comparisons[0].b, "friday");
  ASSERT_THAT(found.comparisons[0].cameras, SizeIs(2));
  for (const PoseComparison& camera : found.comparisons[0].cameras) EXPECT_TRUE(Moved(camera));
}

// Thirty pairs of sessions: by the covariance that the two poses have together, the change is as
// uncertain as is said, and not by far less. With a lens that is known to 0.5% only, two
// calibrations made apart would know it several times worse.
TEST(CalibrateSessions, HowFarACameraMovedIsAsUncertainAsIsSaid) {
  constexpr int kPairs = 30;
  double together = 0;
  double sigma = 0;
  double sigma_apart = 0;
  for (std::uint32_t seed = 100; seed < 100 + kPairs; ++seed) {
    const TwoSessions two(seed);
    const CalibratedSessions found = CalibrateSessions(two.world.rig, two.sessions, Brief());
    ASSERT_THAT(found.comparisons, SizeIs(1)) << seed;
    const PoseComparison& moved = found.comparisons[0].cameras.at(0);
    together += two.Chi2OfChange(moved, 0) / kPairs;
    sigma += moved.rotation_deg[1].sigma;
    const auto apart = [&](std::size_t session) {
      return Calibrate(two.world.rig, two.sessions[session].detections, Brief())
          .cameras[0]
          .calibration.covariance->diagonal()[1];
    };
    sigma_apart += std::sqrt(apart(0) + apart(1)) * 180 / M_PI;
  }
  EXPECT_GT(together, 0.5);
  EXPECT_LT(together, 1.4);  // the mean of 30 pairs' three axes, 0.15 by chance
  EXPECT_LT(sigma, 0.6 * sigma_apart);
}

TEST(CalibrateSessions, CamerasThatStayedAreTheSame) {
  int moved = 0;
  for (std::uint32_t seed = 200; seed < 220; ++seed) {
    const TwoSessions two(seed, 0, 0);
    const CalibratedSessions found = CalibrateSessions(two.world.rig, two.sessions, Brief());
    for (const PoseComparison& camera : found.comparisons.at(0).cameras) {
      moved += Moved(camera) ? 1 : 0;
    }
  }
  EXPECT_LE(moved, 2);  // of forty; once in a hundred each
}

TEST(CalibrateSessions, ThatContradictEachOtherAreNotOne) {
  const TwoSessions two(4);
  const auto comparisons = CalibrateSessions(two.world.rig, two.sessions, Brief()).comparisons;
  const Report both = Calibrate(two.world.rig, two.world.detections, Brief());
  EXPECT_THAT(both.cameras[0].contradiction, IsEmpty());
  const Report report = WithChanges(both, comparisons);
  for (const CameraReport& camera : report.cameras) {
    EXPECT_THAT(camera.contradiction, HasSubstr("friday puts this camera"));
    EXPECT_THAT(camera.contradiction, HasSubstr("from where monday does"));
    EXPECT_THAT(camera.contradiction, HasSubstr("--mounts-moved"));
  }
}

TEST(CalibrateSessions, ASessionOfTooFewViewsDoesNotStopTheOthers) {
  TwoSessions two(5);
  two.sessions[1].detections.resize(1);
  const CalibratedSessions found = CalibrateSessions(two.world.rig, two.sessions, Brief());
  EXPECT_TRUE(found.reports[0].cameras[0].calibration.converged());
  EXPECT_FALSE(found.reports[1].cameras[0].calibration.solved());
  EXPECT_THAT(found.comparisons, IsEmpty());
}

TEST(CalibrateSessions, OnlyTheJointSolveKnowsSessions) {
  const TwoSessions two(6);
  CalibrateOptions options = Brief();
  options.method = kPlaneMethod;
  EXPECT_THROW(CalibrateSessions(two.world.rig, two.sessions, options), InputError);
}

}  // namespace
}  // namespace rgbdt
