#include "calib/present/report/verdict.h"

#include "tests/unit/files/test_data.h"

namespace rgbdt {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

CameraReport Good() {
  CameraReport camera = test::MakeReport().cameras[0];
  camera.other_starts.clear();
  return camera;
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
  EXPECT_EQ(Judge(camera).grade, Grade::kCaution);
  EXPECT_THAT(Judge(camera).reasons, Contains(HasSubstr("1.01 px")));
}

TEST(Verdict, HalvesThatDifferTooMuchContradictTheStatedUncertainty) {
  CameraReport camera = Good();
  camera.halves->chi2 = 22.4;
  EXPECT_EQ(Judge(camera).grade, Grade::kGood);
  camera.halves->chi2 = 22.6;
  EXPECT_EQ(Judge(camera).grade, Grade::kCaution);
  EXPECT_THAT(Judge(camera).reasons, Contains(HasSubstr("uncertainty cannot be trusted")));
}

TEST(Verdict, HalvesWithoutAChiSquareClaimNothing) {
  CameraReport camera = Good();
  camera.halves->chi2 = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(Judge(camera).grade, Grade::kGood);
  EXPECT_THAT(Judge(camera).reasons, Not(Contains(HasSubstr("sigmas allow"))));
}

TEST(Verdict, HeldOutCrossingsAreAsExactAsStatedOrTheVerdictIsCaution) {
  CameraReport camera = Good();
  const auto grade = [&](double rms) {
    camera.edge_rms_whitened.heldout = rms;
    return Judge(camera).grade;
  };
  EXPECT_EQ(grade(0.71), Grade::kGood);
  EXPECT_EQ(grade(1.39), Grade::kGood);
  EXPECT_EQ(grade(0.69), Grade::kCaution);
  EXPECT_THAT(Judge(camera).reasons, Contains(HasSubstr("more exact than stated")));
  EXPECT_EQ(grade(1.41), Grade::kCaution);
  EXPECT_THAT(Judge(camera).reasons, Contains(HasSubstr("less exact than stated")));
  camera.edge_rms_whitened.heldout.reset();
  camera.edge_rms_whitened.train = 5;  // the views used are no judge
  EXPECT_EQ(Judge(camera).grade, Grade::kGood);
}

TEST(Verdict, ViewsThatContradictEachOtherAreTheFirstSentence) {
  CameraReport camera = Good();
  ASSERT_FALSE(camera.folds.empty());
  for (Fold& fold : camera.folds) fold.misfit = 11;
  EXPECT_EQ(Judge(camera).grade, Grade::kGood);
  camera.halves->chi2 = 100;  // an alarm, too, but one that follows from it
  for (Fold& fold : camera.folds) fold.misfit = 50;
  const Verdict verdict = Judge(camera);
  EXPECT_EQ(verdict.grade, Grade::kCaution);
  EXPECT_THAT(verdict.reasons.at(0), HasSubstr("chi-square of 50 where 6 is expected"));
  EXPECT_THAT(verdict.reasons.at(0), HasSubstr("rgbdt intrinsics"));
  EXPECT_THAT(verdict.reasons.at(1), HasSubstr("Two halves"));
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
  camera.view_scatter = ViewScatter{9, 5};
  EXPECT_EQ(Judge(camera).grade, Grade::kCaution);
  EXPECT_THAT(Judge(camera).reasons.at(0), HasSubstr("scatter 3.0 times as much"));
}

}  // namespace
}  // namespace rgbdt
