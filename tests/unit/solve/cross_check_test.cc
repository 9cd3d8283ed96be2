#include "calib/solve/internal/cross_check.h"

#include "calib/methods/calibrate.h"
#include "calib/solve/closure.h"
#include "tests/unit/solve/solve_world.h"

namespace rgbdt {
namespace {

using testing::SizeIs;
using testing::UnorderedElementsAreArray;

SolveWorldOptions Views(int views, std::uint32_t seed = 1) {
  SolveWorldOptions options;
  options.views = views;
  options.seed = seed;
  return options;
}

TEST(CrossValidate, EachViewUsedIsLeftOutOnce) {
  SolveWorldOptions options = Views(11);
  options.heldout_every = 5;
  const SolveWorld world(options);
  const Report report = Calibrate(world.rig, world.detections);
  for (const CameraReport& camera : report.cameras) {
    ASSERT_THAT(camera.folds, SizeIs(5));
    std::vector<std::string> left_out;
    for (const Fold& fold : camera.folds) {
      left_out.insert(left_out.end(), fold.heldout.begin(), fold.heldout.end());
      EXPECT_GT(fold.misfit, 0.5);
      EXPECT_LT(fold.misfit, 15);
      EXPECT_NEAR(fold.edge_rms_whitened, 1, 0.4);
      EXPECT_GT(fold.from_result.translation_mm, 0);
      EXPECT_LT(fold.from_result.translation_mm, 10);
    }
    EXPECT_THAT(left_out, UnorderedElementsAreArray(camera.used));
    EXPECT_EQ(camera.calibration.status, SolveStatus::kConverged);
  }
}

TEST(CrossValidate, OfThreeViewsThereIsNothingToSay) {
  const SolveWorld world(Views(3));
  const Report report = Calibrate(world.rig, world.detections);
  EXPECT_THAT(report.cameras[0].folds, SizeIs(0));
  EXPECT_FALSE(report.cameras[0].halves);
}

TEST(TheBetter, IsTheFirstGuessWhereItFitsBetterBeyondChance) {
  const SolveWorld world(Views(6));
  const SolveSession session(world);
  GuessedCamera camera = session.cameras[0];
  CameraReport& report = camera.views.report;
  const Rigid3 refined = Exp(Vector6d::Constant(1e-3)) * *camera.guess.camera_from_lidar;
  report.calibration.camera_from_lidar = refined;
  report.calibration.status = SolveStatus::kConverged;
  const std::vector<double> within_its_own_scatter{3, -2, 1, -3, 2, 1};
  for (const std::vector<double>& worse :
       {std::vector<double>{}, within_its_own_scatter, {-5, -6, -5, -7, -5, -6}}) {
    const CameraCalibration better = TheBetter(camera, worse);
    EXPECT_THAT(better.camera_from_lidar, Rigid3Near(refined, 0, 0));
    EXPECT_EQ(better.status, SolveStatus::kConverged);
  }
  const CameraCalibration better = TheBetter(camera, {5, 6, 5, 7, 5, 6});
  EXPECT_THAT(better.camera_from_lidar, Rigid3Near(*camera.guess.camera_from_lidar, 0, 0));
  EXPECT_EQ(*better.covariance, camera.guess.covariance);
  EXPECT_EQ(better.status, SolveStatus::kFirstGuessKept);
}

TEST(CrossValidate, OfSessionsFromTheModelTheRefinedPoseIsKept) {
  int guesses_kept = 0;
  double misfit = 0;
  double expected = 0;
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    SolveWorldOptions options = Views(10, 9000 + seed);
    options.draw_nuisances = true;
    options.side_sigma_rad = BoardPriors().side_sigma_rad;
    const SolveWorld world(options);
    for (const CameraReport& camera : Calibrate(world.rig, world.detections).cameras) {
      guesses_kept += camera.calibration.status != SolveStatus::kConverged ? 1 : 0;
      for (const Fold& fold : camera.folds) {
        misfit += fold.misfit;
        expected += fold.expected_misfit;
      }
    }
  }
  EXPECT_LT(misfit, 1.2 * expected);
  EXPECT_GT(misfit, 0.6 * expected);
  EXPECT_LE(guesses_kept, 2);  // of 40
}

TEST(CrossValidate, HalvesDifferAsTheirCovariancesSay) {
  constexpr int kSessions = 40;
  std::array<double, 2> chi2{};
  for (std::uint32_t seed = 0; seed < kSessions; ++seed) {
    const SolveWorld world(Views(10, 300 + seed));
    const SolveSession session(world);
    JointResult result;
    result.joint = session.Joint();
    result.solution = SolveBoards(result.joint.problem, result.joint.start);
    result = CrossValidate(std::move(result), 2);
    for (std::size_t c = 0; c < 2; ++c) {
      const auto& halves = result.joint.cameras[c].views.report.halves;
      ASSERT_TRUE(halves);
      chi2[c] += halves->chi2 / kSessions;
    }
  }
  // Classes, thickness and outline are as is likeliest, the same for both halves: less than 6.
  for (const double mean : chi2) {
    EXPECT_GT(mean, 2.5);
    EXPECT_LT(mean, 7.6);
  }
}

// Of views that had no say, against the truth and against a wrong pose.
TEST(MisfitOf, IsSixOnAverageOfTheTruth) {
  SolveWorldOptions options = Views(60);
  options.side_sigma_rad = BoardPriors().side_sigma_rad;
  const SolveWorld world(options);
  const SolveSession session(world);
  const JointProblem joint = session.Joint();
  BoardState truth = joint.start;
  truth.camera_from_lidar = world.camera_from_lidar;
  BoardState wrong = truth;
  wrong.camera_from_lidar[0] = RotationAbout({0, 1, 0}, 0.01) * wrong.camera_from_lidar[0];
  double sum = 0;
  for (std::size_t v = 0; v < joint.problem.views.size(); ++v) {
    auto [alone, start] = Part(joint.problem, {v}, truth);
    alone.views[0].images.resize(1);
    ASSERT_EQ(alone.views[0].images[0].camera, 0);
    const double misfit = MisfitOf(alone, start, 0, 0).chi2;
    sum += misfit / static_cast<double>(joint.problem.views.size());
    start.camera_from_lidar[0] = wrong.camera_from_lidar[0];
    EXPECT_GT(MisfitOf(alone, start, 0, 0).chi2, misfit);
  }
  // Corners are independent here, and counted as a little correlated: less than 6, if anything.
  EXPECT_GT(sum, 4);
  EXPECT_LT(sum, 6 + 3.3 * std::sqrt(12 / 60.0));
}

std::vector<Closure> LoopsOf(const SolveWorld& world) {
  SolveSession session(world);
  for (GuessedCamera& camera : session.cameras) {
    camera.guess = GuessFromBoards(camera.views.Used());
    if (!camera.guess.camera_from_lidar) return {};
  }
  return CloseLoops(session.cameras);
}

TEST(CloseLoops, ImagesAndLidarAgreeAndDifferAsTheyShould) {
  constexpr int kSessions = 60;
  double chi2 = 0;
  for (std::uint32_t seed = 0; seed < kSessions; ++seed) {
    SolveWorldOptions options = Views(8, 700 + seed);
    options.nuisances_by_view = true;
    options.side_sigma_rad = BoardPriors().side_sigma_rad;
    const SolveWorld world(options);
    const auto loops = LoopsOf(world);
    ASSERT_THAT(loops, SizeIs(1));
    EXPECT_EQ(loops[0].from, "rgb");
    EXPECT_EQ(loops[0].to, "thermal");
    const Rigid3 truth = world.camera_from_lidar[1] * world.camera_from_lidar[0].Inverse();
    EXPECT_THAT(loops[0].by_images, Rigid3Near(truth, 0.01, 0.03));
    EXPECT_THAT(loops[0].by_lidar, Rigid3Near(truth, 0.01, 0.03));
    chi2 += loops[0].chi2 / kSessions;
  }
  EXPECT_NEAR(chi2, 6, 3.3 * std::sqrt(12.0 / kSessions));
}

TEST(CloseLoops, WithoutNoiseTheyAreTheSame) {
  SolveWorldOptions options = Views(6);
  options.noise = 0;
  const auto loops = LoopsOf(SolveWorld(options));
  ASSERT_THAT(loops, SizeIs(1));
  EXPECT_THAT(loops[0].by_images, Rigid3Near(loops[0].by_lidar, 1e-7, 1e-7));
  EXPECT_LT(loops[0].chi2, 1e-6);
}

// Each image pose of the second camera changed by `change`.
template <typename Change>
Closure LoopWith(Change change) {
  SolveWorld world(Views(10));
  for (std::size_t v = 0; v < 10; ++v) {
    change(&world.ImageAt(v, 1).pose->sensor_from_target);
  }
  const auto loops = LoopsOf(world);
  return loops.size() == 1 ? loops[0] : Closure{};
}

TEST(CloseLoops, ImagesInWhichBoardsSeemFartherThanTheyAreDoNotClose) {
  EXPECT_LT(LoopWith([](Rigid3* /*pose*/) {}).chi2, 22.5);
  const Closure wrong = LoopWith([](Rigid3* pose) { pose->translation *= 1.03; });
  EXPECT_GT(wrong.chi2, 200);
  EXPECT_GT(wrong.difference.translation_mm, 3 * wrong.sigma.translation_mm);
}

TEST(CloseLoops, ImagesWhosePatternIsNotInTheBoardsMiddleDoNotClose) {
  const Closure wrong = LoopWith([](Rigid3* pose) {
    *pose = *pose * Rigid3{{1, 0, 0, 0}, {0.03, 0, 0}};
  });
  EXPECT_GT(wrong.chi2, 50);
}

TEST(CloseLoops, AnErrorThatMovesAllOfACamerasPosesAlikeMovesBothWaysAlikeAndDoesNotShow) {
  const Closure right = LoopWith([](Rigid3* /*pose*/) {});
  const Closure moved = LoopWith([](Rigid3* pose) { pose->translation.x() += 0.05; });
  EXPECT_NEAR(moved.by_images.translation.x() - right.by_images.translation.x(), 0.05, 0.001);
  EXPECT_NEAR(moved.by_lidar.translation.x() - right.by_lidar.translation.x(), 0.05, 0.001);
  EXPECT_NEAR(moved.chi2, right.chi2, 0.5);
}

}  // namespace
}  // namespace rgbdt
