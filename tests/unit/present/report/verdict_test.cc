#include "calib/present/report/verdict.h"

#include "calib/present/report/session_verdict.h"
#include "tests/unit/files/test_data.h"

namespace rgbdt {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

CameraReport Good() {
  CameraReport camera = test::MakeReport().cameras[0];
  camera.other_starts.clear();
  return camera;
}

Cause Wrong(double chi2, std::optional<double> moves_sigma) {
  return {"squares", "the squares are 3.0% larger than given", chi2, 1, moves_sigma};
}

TEST(Verdict, AGoodReportIsConsistentAndSaysWhy) {
  const Verdict verdict = Judge(Good());
  EXPECT_EQ(verdict.grade, Grade::kGood);
  EXPECT_THAT(verdict.reasons, Contains(HasSubstr("0.60 px (1 sigma) where it is worst")));
  EXPECT_THAT(verdict.reasons, Contains(HasSubstr("no more than their sigmas allow")));
}

TEST(Verdict, ADegeneratePoseIsBadAndSaysWhatToDoNext) {
  CameraReport camera = Good();
  camera.calibration.detail = "all boards are parallel";
  for (const SolveStatus status : {SolveStatus::kDegenerate, SolveStatus::kUndetermined}) {
    camera.calibration.status = status;
    const Verdict verdict = Judge(camera, test::MakeReport().next_view);
    EXPECT_EQ(verdict.grade, Grade::kBad);
    EXPECT_THAT(verdict.headline, HasSubstr("do not determine the pose"));
    EXPECT_THAT(verdict.reasons, Contains(HasSubstr("all boards are parallel")));
    EXPECT_THAT(verdict.reasons,
                Contains("Next: Hold the board 6 m ahead, at the image's top left."));
  }
  EXPECT_THAT(Judge(camera).reasons, Not(Contains(HasSubstr("Next:"))));
}

TEST(Verdict, WhyManyViewsAreMissingComesBeforeWhatTheRestDoNotDetermine) {
  CameraReport camera = Good();
  camera.calibration.status = SolveStatus::kDegenerate;
  camera.calibration.detail = "all boards are parallel";
  camera.used = {"1", "2"};
  camera.heldout = {"3"};
  camera.rejected = {{"4", "sizes do not fit"}, {"5", "sizes do not fit"}};
  EXPECT_THAT(Judge(camera).reasons, Not(Contains(HasSubstr("sizes do not fit"))));
  camera.rejected.push_back({"6", "sizes do not fit"});
  const Verdict verdict = Judge(camera);
  EXPECT_EQ(verdict.reasons.at(0), "3 views rejected (4, 5, 6), 4: sizes do not fit.");
  EXPECT_THAT(verdict.reasons.at(1), HasSubstr("all boards are parallel"));
  EXPECT_THAT(verdict.reasons, Not(Contains(HasSubstr("Rejected: 3 of 6")))) << "once is enough";
}

TEST(Verdict, WhatContradictsACalibrationThatWasJudgedBeforeIsSaidOnce) {
  CameraReport camera = Good();
  camera.causes = {Wrong(100, 10)};
  const std::string why = Judge(camera).reasons.at(0);
  camera.calibration.status = SolveStatus::kContradicted;
  camera.calibration.detail = why;
  EXPECT_EQ(Judge(camera).reasons.at(0), why);
  EXPECT_THAT(Judge(camera).reasons, Not(Contains(HasSubstr("Status of the solve"))));
  camera.causes.clear();  // judged where its report is not known
  EXPECT_EQ(Judge(camera).grade, Grade::kBad);
  EXPECT_EQ(Judge(camera).reasons.at(0),
            "Status of the solve: contradicted: do not use it: " + why);
}

TEST(Verdict, TheStatusOfAConvergedSolveIsAReasonWithoutAlarm) {
  CameraReport camera = Good();
  camera.calibration.status = SolveStatus::kFirstGuessKept;
  const Verdict verdict = Judge(camera);
  EXPECT_EQ(verdict.grade, Grade::kGood);
  EXPECT_THAT(verdict.reasons, Contains(HasSubstr("the first guess was kept")));
}

TEST(Verdict, MoreThanAPixelOfReprojectionUncertaintyAtFiveMetresIsAWarning) {
  CameraReport camera = Good();
  camera.sigma->colouring[0].worst_px = camera.sigma->colouring[3].worst_px = 9;  // 2 and 50 m
  EXPECT_EQ(Judge(camera).grade, Grade::kGood);
  camera.sigma->colouring[1].worst_px = 1.01;
  EXPECT_EQ(Judge(camera).grade, Grade::kUsable);
  EXPECT_THAT(Judge(camera).reasons, Contains(HasSubstr("1.01 px")));
  camera.sigma->colouring[1].worst_px = 99;
  EXPECT_EQ(Judge(camera).grade, Grade::kUsable);
  camera.sigma->colouring[1].worst_px = 101;
  EXPECT_EQ(Judge(camera).grade, Grade::kDoubtful);
  EXPECT_THAT(Judge(camera).reasons.at(0), HasSubstr("too uncertain"));
}

TEST(Verdict, HalvesThatDifferTooMuchContradictTheStatedUncertainty) {
  CameraReport camera = Good();
  camera.halves->chi2 = 22.4;
  EXPECT_EQ(Judge(camera).grade, Grade::kGood);
  camera.halves->chi2 = 22.6;
  EXPECT_EQ(Judge(camera).grade, Grade::kDoubtful);
  EXPECT_THAT(Judge(camera).reasons, Contains(HasSubstr("uncertainty cannot be trusted")));
}

TEST(Verdict, EdgesAndPlanesThatDisagreeAreToldAndByFarAreDoubtful) {
  CameraReport camera = Good();
  camera.edges_planes = Halves{{0.6, 20}, 22.4};
  EXPECT_EQ(Judge(camera).grade, Grade::kGood);
  camera.edges_planes->chi2 = 30;
  EXPECT_EQ(Judge(camera).grade, Grade::kUsable);
  EXPECT_THAT(Judge(camera).reasons.at(0), HasSubstr("The boards' edges alone"));
  camera.edges_planes->difference = {0.6, 110};
  EXPECT_EQ(Judge(camera).grade, Grade::kDoubtful);
  camera.edges_planes->difference = {1.1, 20};
  EXPECT_EQ(Judge(camera).grade, Grade::kDoubtful);
}

TEST(Verdict, ASigmaThatHasTheDistanceOfEdgesAndPlanesInItIsUsable) {
  CameraReport camera = Good();
  camera.edges_planes = Halves{{2.5, 200}, 60, 3.2};
  EXPECT_EQ(Judge(camera).grade, Grade::kUsable);
  EXPECT_THAT(Judge(camera).reasons.at(0), HasSubstr("stated sigma is large enough to allow it"));
}

TEST(Verdict, ASceneIsJudgedBySweepsLeftOut) {
  CameraReport camera = Good();
  camera.edge_rms_px = {};
  camera.scene = SceneCheck{1000, 0.4, 0.1, 0.2};
  EXPECT_EQ(Judge(camera).grade, Grade::kUsable);
  EXPECT_THAT(Judge(camera).reasons.at(0), HasSubstr("Refine in another place"));
  camera.scene->joined = true;
  EXPECT_EQ(Judge(camera).grade, Grade::kGood) << "what is known by other data counts, too";
  EXPECT_THAT(Judge(camera).reasons, Contains(HasSubstr("On sweeps that the solver never saw")));
  camera.scene->joined = false;
  camera.scene->heldout_result.reset();
  EXPECT_EQ(Judge(camera).grade, Grade::kUsable);
  EXPECT_THAT(Judge(camera).reasons.at(0), HasSubstr("It was not checked"));
  // The page says the same.
  EXPECT_EQ(VerdictOf({"rgb", true, 0, &camera}, std::nullopt).grade, Grade::kUsable);
}

TEST(Verdict, HalvesWithoutAChiSquareClaimNothing) {
  CameraReport camera = Good();
  camera.halves->chi2 = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(Judge(camera).grade, Grade::kGood);
  EXPECT_THAT(Judge(camera).reasons, Not(Contains(HasSubstr("sigmas allow"))));
}

TEST(Verdict, HeldOutCrossingsThatAreLessExactThanStatedAreDoubtful) {
  CameraReport camera = Good();
  const auto grade = [&](double rms) {
    camera.edge_rms_whitened.heldout = rms;
    camera.views = {{"1", true, 1, 1, rms}, {"2", true, 1, 1, rms}, {"3", true, 1, 1, rms}};
    return Judge(camera).grade;
  };
  EXPECT_EQ(grade(0.71), Grade::kGood);
  EXPECT_EQ(grade(1.39), Grade::kGood);
  EXPECT_EQ(grade(0.69), Grade::kGood);
  EXPECT_THAT(Judge(camera).reasons, Contains(HasSubstr("more exact than stated")));
  EXPECT_EQ(grade(1.41), Grade::kDoubtful);
  EXPECT_THAT(Judge(camera).reasons, Contains(HasSubstr("less exact than stated")));
  EXPECT_EQ(grade(4.9), Grade::kDoubtful);
  EXPECT_EQ(grade(5.1), Grade::kBad);
  EXPECT_THAT(Judge(camera).reasons, Contains(HasSubstr("not where this pose puts them")));
  camera.variance_factor = 4;  // the stated uncertainty was enlarged for it
  EXPECT_EQ(grade(2.7), Grade::kGood);
  EXPECT_EQ(grade(2.9), Grade::kDoubtful);
  camera.variance_factor = 1;
  grade(1.5);
  camera.views[0].edge_rms_whitened = camera.views[1].edge_rms_whitened = 1;  // a single bad view
  EXPECT_EQ(Judge(camera).grade, Grade::kUsable);
  camera.edge_rms_whitened.heldout.reset();
  camera.edge_rms_whitened.train = 5;  // the views used are no judge
  EXPECT_EQ(Judge(camera).grade, Grade::kGood);
}

TEST(Verdict, ViewsThatContradictEachOtherAreTheFirstSentence) {
  CameraReport camera = Good();
  ASSERT_FALSE(camera.folds.empty());
  for (Fold& fold : camera.folds) fold.misfit = 11;
  EXPECT_EQ(Judge(camera).grade, Grade::kGood);
  for (Fold& fold : camera.folds) fold.misfit = 50;
  EXPECT_EQ(Judge(camera).grade, Grade::kUsable);
  EXPECT_THAT(Judge(camera).reasons.at(0), HasSubstr("chi-square of 50 where 6 is expected"));
  EXPECT_THAT(Judge(camera).reasons.at(0), HasSubstr("rgbdt intrinsics"));
  camera.halves->chi2 = 100;
  EXPECT_EQ(Judge(camera).grade, Grade::kDoubtful);
  EXPECT_THAT(Judge(camera).reasons.at(0), HasSubstr("Two halves"));  // the worst comes first
}

TEST(Verdict, SessionsThatContradictEachOtherAreNotToBeUsed) {
  CameraReport camera = Good();
  camera.contradiction = "friday puts this camera elsewhere than monday does.";
  const Verdict verdict = Judge(camera);
  EXPECT_EQ(verdict.grade, Grade::kBad);
  EXPECT_EQ(verdict.reasons.at(0), camera.contradiction);
}

TEST(Verdict, ViewsThatScatterFarMoreThanStatedAreAnAlarm) {
  CameraReport camera = Good();
  camera.view_scatter = ViewScatter{2.4, 40};
  EXPECT_EQ(Judge(camera).grade, Grade::kGood);
  camera.view_scatter = ViewScatter{3, 5};  // once in a hundred times by chance
  EXPECT_NEAR(camera.view_scatter->Chance(), 0.0104, 0.001);
  EXPECT_EQ(Judge(camera).grade, Grade::kGood);
  camera.view_scatter = ViewScatter{4, 40};
  EXPECT_EQ(Judge(camera).grade, Grade::kUsable);
  camera.view_scatter = ViewScatter{9, 5};
  EXPECT_EQ(Judge(camera).grade, Grade::kDoubtful);
  EXPECT_THAT(Judge(camera).reasons.at(0), HasSubstr("scatter 3.0 times as much"));
}

// Of few views chance may make as much, but the sigma has it already.
TEST(Verdict, ASigmaThatWasMuchEnlargedIsSaidAndNoMoreViewsAreAdvised) {
  CameraReport camera = Good();
  camera.view_scatter = ViewScatter{5, 2.5};
  camera.variance_factor = 2.4;
  camera.edge_rms_px = {1.4, 3.1};
  EXPECT_THAT(Judge(camera).reasons.at(0), HasSubstr("take more views"));
  camera.variance_factor = 4;
  const Verdict verdict = Judge(camera);
  EXPECT_EQ(verdict.grade, Grade::kUsable);
  EXPECT_THAT(verdict.reasons, Contains(HasSubstr("sigma was enlarged 2.0 times")));
  EXPECT_THAT(verdict.reasons, Contains(AllOf(HasSubstr("3.10 px RMS"), HasSubstr("stood still"))));
  EXPECT_THAT(verdict.reasons, Not(Contains(HasSubstr("take more views"))));
}

TEST(Verdict, ASolveOfEnoughViewsThatFailedIsNotOneToCome) {
  CameraReport camera;
  camera.calibration.camera = "rgb";
  camera.calibration.detail = "the views do not agree where the camera is";
  camera.used = {"1", "2", "3"};
  const JudgedCamera judged{"rgb", false, 11, &camera};
  EXPECT_EQ(VerdictOfAll({judged}, std::nullopt).headline, "No calibration yet");
  camera.rejected.resize(8);
  const Verdict all = VerdictOfAll({judged}, std::nullopt);
  EXPECT_EQ(all.grade, Grade::kBad);
  EXPECT_THAT(all.headline, HasSubstr("o not use"));
  EXPECT_THAT(all.reasons, Contains(HasSubstr("do not agree where the camera is")));
}

TEST(Verdict, WhatViewsCannotTellIsSaidAndNoMoreThanUsable) {
  CameraReport camera = Good();
  ASSERT_EQ(Judge(camera).grade, Grade::kGood);
  camera.cannot_tell = "All sweeps turned the same way.";
  const Verdict verdict = Judge(camera);
  EXPECT_EQ(verdict.grade, Grade::kUsable);
  EXPECT_THAT(verdict.reasons, testing::Contains(camera.cannot_tell));
}

TEST(Verdict, WhatWasGivenWrongCountsByWhatItMoves) {
  CameraReport camera = Good();
  const auto grade = [&](double chi2, std::optional<double> moves_sigma) {
    camera.causes = {Wrong(chi2, moves_sigma)};
    return Judge(camera).grade;
  };
  EXPECT_EQ(grade(12.2, 3.9), Grade::kGood);  // by chance once in 2,000 times
  EXPECT_EQ(grade(6.2, 10), Grade::kGood);
  EXPECT_EQ(grade(6.3, 10), Grade::kDoubtful) << "chance, or a result that is far off";
  EXPECT_THAT(Judge(camera).reasons.at(0), HasSubstr("It may be chance (2.5 sigma): measure it"));
  camera.causes = {Wrong(16, 0.5), Wrong(14.4, 0.4), Wrong(9, 8)};
  EXPECT_EQ(Judge(camera).grade, Grade::kDoubtful) << "whatever is surer and moves little";
  EXPECT_EQ(grade(12.3, 0.9), Grade::kUsable);
  EXPECT_THAT(Judge(camera).reasons.at(0), HasSubstr("moves the result by 0.9 sigma"));
  EXPECT_EQ(grade(12.3, 0.04), Grade::kUsable);
  EXPECT_THAT(Judge(camera).reasons.at(0), Not(HasSubstr("moves the result")));
  EXPECT_EQ(grade(12.3, 1.1), Grade::kDoubtful);
  EXPECT_EQ(grade(12.3, std::nullopt), Grade::kDoubtful);
  EXPECT_EQ(grade(12.3, 4.1), Grade::kBad);
  EXPECT_THAT(Judge(camera).reasons.at(0),
              AllOf(HasSubstr("Likeliest cause: the squares are 3.0% larger than given."),
                    HasSubstr("moves the result by 4.1 sigma")));
}

TEST(Verdict, TheLikeliestAndTheSecondLikeliestCauseAreNamed) {
  CameraReport camera = Good();
  camera.causes = {Wrong(25, 3),
                   {"focal length", "the focal length is too long", 16, 1, 3.0},
                   {"board's size", "the board is wider", 12, 2, 3.0}};
  const Verdict verdict = Judge(camera);
  EXPECT_EQ(verdict.grade, Grade::kDoubtful);
  EXPECT_THAT(verdict.reasons.at(0), HasSubstr("Likeliest cause: the squares"));
  EXPECT_THAT(verdict.reasons.at(1), HasSubstr("Second likeliest: the focal length"));
  EXPECT_THAT(verdict.reasons, Not(Contains(HasSubstr("the board is wider"))));
}

// The first cause alone makes it doubtful: that is alarm enough to name another that may be it.
TEST(Verdict, TheSecondLikeliestIsNamedBesideAFirstThatAloneIsTheAlarm) {
  CameraReport camera = Good();
  camera.causes = {Wrong(25, 3), {"focal length", "the focal length is too long", 4, 1, 3.0}};
  const Verdict verdict = Judge(camera);
  EXPECT_EQ(verdict.grade, Grade::kDoubtful);
  EXPECT_THAT(verdict.reasons.at(0), HasSubstr("Likeliest cause: the squares"));
  EXPECT_THAT(verdict.reasons.at(1), HasSubstr("Second likeliest: the focal length"));
  camera.causes[0].moves_sigma = 0.5;
  EXPECT_EQ(Judge(camera).grade, Grade::kUsable);
  EXPECT_THAT(Judge(camera).reasons, Not(Contains(HasSubstr("Second likeliest"))));
}

// Where something else says that all is not well, what is less sure is worth a look.
TEST(Verdict, AnUnsureCauseIsNamedOnlyBesideAnotherAlarm) {
  CameraReport camera = Good();
  camera.causes = {Wrong(4, 3)};
  EXPECT_THAT(Judge(camera).reasons, Not(Contains(HasSubstr("Likeliest cause"))));
  camera.view_scatter = ViewScatter{9, 5};
  EXPECT_THAT(Judge(camera).reasons, Contains(HasSubstr("Likeliest cause: the squares")));
  camera.contradiction = "Images and clouds are 1 apart";
  EXPECT_THAT(Judge(camera).reasons, Not(Contains(HasSubstr("Likeliest cause"))));
}

// A sigma that was enlarged covers it, and so it is usable; what is behind it may be easy to mend.
TEST(Verdict, ACauseThatIsNearlySureIsNamedWhereTheSigmaWasEnlarged) {
  CameraReport camera = Good();
  camera.causes = {Wrong(9, 3)};
  camera.view_scatter = ViewScatter{3, 5};  // of few views, which chance may make scatter
  camera.variance_factor = 3;
  EXPECT_EQ(Judge(camera).grade, Grade::kUsable);
  EXPECT_THAT(Judge(camera).reasons, Contains(HasSubstr("Likeliest cause: the squares")));
  camera.causes = {Wrong(4, 3)};
  EXPECT_THAT(Judge(camera).reasons, Not(Contains(HasSubstr("Likeliest cause"))));
}

TEST(Verdict, WhyThereIsNoPoseComesBeforeThatThereIsNone) {
  CameraReport camera = Good();
  camera.calibration.status = SolveStatus::kNotSolved;
  camera.calibration.covariance.reset();
  EXPECT_THAT(Judge(camera).reasons.at(0), HasSubstr("There was no solve"));
  camera.causes = {Wrong(25, std::nullopt)};
  EXPECT_EQ(Judge(camera).grade, Grade::kBad);
  EXPECT_THAT(Judge(camera).reasons.at(0), HasSubstr("Likeliest cause: the squares"));
  camera.contradiction = "Images and clouds are 1 apart";
  EXPECT_EQ(Judge(camera).reasons.at(0), camera.contradiction);
}

TEST(Verdict, ManyRejectedViewsAreDoubtful) {
  CameraReport camera = Good();
  camera.used = {"1", "2", "3", "4", "5", "6"};
  camera.heldout = {"7", "8", "9"};
  camera.rejected = {{"a", "why"}, {"b", "why"}, {"c", "why"}};
  EXPECT_EQ(Judge(camera).grade, Grade::kGood);
  camera.rejected.push_back({"d", "why"});
  EXPECT_EQ(Judge(camera).grade, Grade::kDoubtful);
  EXPECT_THAT(Judge(camera).reasons.at(0), HasSubstr("Rejected: 4 of 13 views"));
}

TEST(Verdict, CopiesOfViewsAreNoAlarm) {
  CameraReport camera = Good();
  for (int i = 0; i < 12; ++i) {
    camera.rejected.push_back({"copy" + std::to_string(i), "it counts once", true});
  }
  EXPECT_EQ(Judge(camera).grade, Grade::kGood);
  for (RejectedView& view : camera.rejected) view.copy = false;
  EXPECT_EQ(Judge(camera).grade, Grade::kDoubtful);
}

TEST(Verdict, WhyMostViewsWereRejectedIsSaid) {
  CameraReport camera = Good();
  camera.used = {"1", "2", "3"};
  camera.rejected = {{"a", "too dark"}, {"b", "no board in 12 s"}, {"c", "no board in 5 s"}};
  EXPECT_EQ(Judge(camera).reasons.at(0), "Rejected: 3 of " +
                                             std::to_string(6 + camera.heldout.size()) +
                                             " views; 2 of them alike, as b: no board in 12 s.");
  camera.rejected.back().why = "glare";
  EXPECT_THAT(Judge(camera).reasons.at(0), HasSubstr("why stands in the table of views"));
}

// Whatever sigma is stated: sensors do not leave that much.
TEST(Verdict, ResidualsBeyondWhatLidarsLeaveAreDoubtful) {
  for (TrainHeldout CameraReport::*rms :
       {&CameraReport::edge_rms_mm, &CameraReport::plane_rms_mm}) {
    CameraReport camera = Good();
    camera.*rms = {30, 59};
    EXPECT_EQ(Judge(camera).grade, Grade::kGood);
    camera.*rms = {75, 59};
    EXPECT_EQ(Judge(camera).grade, Grade::kDoubtful);
    EXPECT_THAT(Judge(camera).reasons.at(0), HasSubstr("by up to 75 mm RMS"));
  }
}

TEST(Verdict, AMethodWithoutACovarianceIsNoMoreThanUsable) {
  CameraReport camera = Good();
  camera.calibration.covariance.reset();
  EXPECT_EQ(Judge(camera).grade, Grade::kUsable);
  EXPECT_THAT(Judge(camera).reasons, Contains(HasSubstr("cannot be told by this method")));
}

TEST(NextViewOf, IsNoneWhereSomethingElseHasToBeCorrectedFirst) {
  Report report = test::MakeReport();
  report.cameras = {Good()};
  CameraReport& camera = report.cameras[0];
  camera.sigma->colouring[1].worst_px = 2;
  ASSERT_NE(NextViewOf(report), nullptr);
  EXPECT_THAT(Judge(camera).reasons, Contains(HasSubstr("take more views")));
  camera.calibration.status = SolveStatus::kDegenerate;
  EXPECT_NE(NextViewOf(report), nullptr) << "more views are what is missing";
  camera.calibration.status = SolveStatus::kConverged;
  camera.causes = {Wrong(100, 10)};
  EXPECT_EQ(NextViewOf(report), nullptr);
  EXPECT_THAT(Judge(camera).reasons, Not(Contains(HasSubstr("more views"))));
  camera.causes.clear();
  camera.calibration.status = SolveStatus::kNotSolved;
  EXPECT_NE(NextViewOf(report), nullptr);
  camera.contradiction = "Images and clouds are 1 apart";
  EXPECT_EQ(NextViewOf(report), nullptr);
  report.next_view.reset();
  report.cameras.clear();
  EXPECT_EQ(NextViewOf(report), nullptr);
}

TEST(JudgedCalibration, WhatIsDoubtfulOrNotToBeUsedSaysSo) {
  const Rig rig = test::MakeRig();
  Report report = test::MakeReport();
  EXPECT_EQ(JudgedCalibration(report, rig).cameras[0].status, report.cameras[0].calibration.status);
  report.cameras[0].calibration.status = SolveStatus::kConverged;
  report.cameras[0].causes = {Wrong(100, 2)};
  const Calibration doubtful = JudgedCalibration(report, rig);
  EXPECT_TRUE(doubtful.cameras[0].converged());
  EXPECT_THAT(doubtful.cameras[0].detail, testing::StartsWith("doubtful: Likeliest cause: "));
  report.cameras[0].causes = {Wrong(100, 10)};
  const Calibration judged = JudgedCalibration(report, rig);
  EXPECT_EQ(judged.cameras[0].status, SolveStatus::kContradicted);
  EXPECT_THAT(judged.cameras[0].detail, HasSubstr("the squares are 3.0% larger"));
  EXPECT_FALSE(judged.cameras[0].converged());
  ASSERT_TRUE(judged.sensors);
  EXPECT_EQ(judged.sensors->cameras[0].lens, rig.cameras[0].lens);
  EXPECT_EQ(GradeOf(report), Grade::kBad);
  EXPECT_EQ(WithVerdicts(report).cameras[0].verdict->grade, Grade::kBad);
}

}  // namespace
}  // namespace rgbdt
