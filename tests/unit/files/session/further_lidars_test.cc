// LIDARs beside the reference, in every file that knows of them.
#include "calib/files/atomic_file.h"
#include "calib/files/schema/calibration_file.h"
#include "calib/files/schema/exports.h"
#include "calib/files/schema/report_file.h"
#include "calib/files/schema/rig_file.h"
#include "calib/files/session/session_dir.h"
#include "calib/model/pose_sigma.h"
#include "tests/unit/files/test_data.h"

namespace rgbdt {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

LidarSpec Rear() {
  LidarSpec rear;
  rear.name = "rear";
  rear.range_sigma_m = 0.012;
  rear.range_offset_sigma_m = 0.03;
  return rear;
}

Rig TwoLidars() {
  Rig rig = test::MakeRig();
  rig.further_lidars = {Rear()};
  return rig;
}

LidarReport MakeLidarReport() {
  LidarReport report;
  report.calibration.lidar = "rear";
  report.calibration.reference_from_lidar = test::MakePose(0.7, {-0.3, 0.35, 0.2});
  Matrix6d covariance = Matrix6d::Identity() * 1e-6;
  covariance(0, 4) = covariance(4, 0) = 2e-7;
  report.calibration.covariance = covariance;
  report.calibration.status = SolveStatus::kConverged;
  report.calibration.detail = "of a test";
  report.first_guess = test::MakePose(0.71, {-0.31, 0.35, 0.2});
  report.used = {"0001", "0004"};
  report.rejected = {{"0002", "the board moved"}};
  report.warnings = {"the top side is left out"};
  report.sigma = SigmaOf(report.calibration);
  report.nuisance = {{"range offset", "mm", {3.5, 0.6}}};
  report.truth_error = PoseError{0.012, 0.9};
  return report;
}

Report MakeReportOfTwo() {
  Report report = test::MakeReport();
  report.lidars = {MakeLidarReport()};
  return report;
}

TEST(FurtherLidars, TheFirstOfTheRigFileIsTheReferenceAndOneAloneIsWrittenAsBefore) {
  const Rig rig = TwoLidars();
  const Rig back = ParseRig(PrintRig(rig), "rig.textproto");
  EXPECT_EQ(back.lidar.name, rig.lidar.name);
  ASSERT_EQ(back.further_lidars.size(), 1U);
  EXPECT_EQ(back.further_lidars[0].name, "rear");
  EXPECT_EQ(back.further_lidars[0].range_sigma_m, 0.012);
  EXPECT_EQ(back.further_lidars[0].range_offset_sigma_m, 0.03);
  EXPECT_EQ(PrintRig(back), PrintRig(rig));
  const Rig one = ParseRig(PrintRig(test::MakeRig()), "rig.textproto");
  EXPECT_THAT(one.further_lidars, IsEmpty());
}

TEST(FurtherLidars, EachHasANameOfItsOwnThatAFileMayHave) {
  for (const char* name : {"Rear", "", "a/b"}) {
    Rig rig = TwoLidars();
    rig.further_lidars[0].name = name;
    EXPECT_THAT(test::ErrorOf([&] { rig.Check(); }), HasSubstr("lidar.name")) << name;
  }
  Rig rig = TwoLidars();
  rig.further_lidars.push_back(Rear());
  EXPECT_THAT(test::ErrorOf([&] { rig.Check(); }), HasSubstr("\"rear\" twice"));
  rig = TwoLidars();
  rig.further_lidars[0].name = rig.cameras[0].name;
  EXPECT_THAT(test::ErrorOf([&] { rig.Check(); }), HasSubstr("twice"));
  rig = TwoLidars();
  rig.further_lidars[0].range_sigma_m = -1;
  EXPECT_THAT(test::ErrorOf([&] { rig.Check(); }), HasSubstr("lidar \"rear\".range_sigma_m"));
}

TEST(FurtherLidars, ARigWithoutOneDiffersFromARigWithIt) {
  EXPECT_THAT(DifferencesOf(TwoLidars(), TwoLidars()), IsEmpty());
  EXPECT_THAT(DifferencesOf(test::MakeRig(), TwoLidars()), ElementsAre(HasSubstr("lidar[1]")));
  Rig other = TwoLidars();
  other.lidar.range_sigma_m *= 2;
  EXPECT_THAT(DifferencesOf(TwoLidars(), other), ElementsAre(HasSubstr("lidar.range_sigma_m")));
}

/// A session of one view, with a cloud of the second LIDAR.
class FurtherClouds : public ::testing::Test {
 protected:
  FurtherClouds() {
    WriteRig(dir_.path(), TwoLidars());
    View view = test::MakeView();
    view.name = "0001";
    view.further_clouds = {{"rear", test::MakeCloud()}};
    view.further_clouds[0].cloud.sweep_utime = view.cloud.sweep_utime;
    for (Eigen::Vector3f& point : view.further_clouds[0].cloud.points) point.x() += 0.5F;
    WriteView(dir_.path(), view);
  }

  std::string ErrorOf(const std::string& further_cloud) const {
    const fs::path file = dir_ / "views/0001/view.textproto";
    WriteFileAtomically(
        file,
        "cloud: \"cloud.pcd\"\nimage { camera: \"rgb\" file: \"rgb.png\" }\n" + further_cloud);
    return test::ErrorOf([&] { ReadView(OpenSession(dir_.path()), "0001"); });
  }

  test::TempDir dir_;
};

TEST_F(FurtherClouds, StandBesideTheReferences) {
  EXPECT_TRUE(fs::exists(dir_ / "views/0001/cloud_rear.pcd"));
  const View back = ReadView(OpenSession(dir_.path()), "0001");
  ASSERT_EQ(back.further_clouds.size(), 1U);
  EXPECT_EQ(back.further_clouds[0].lidar, "rear");
  EXPECT_EQ(back.further_clouds[0].cloud.points.size(), test::MakeCloud().points.size());
  EXPECT_EQ(back.further_clouds[0].cloud.sweep_utime, back.cloud.sweep_utime);
}

TEST_F(FurtherClouds, ThePointsOfTheReferenceAreNotAnothers) {
  EXPECT_THAT(ErrorOf("further_cloud { lidar: \"rear\" file: \"cloud.pcd\" }\n"),
              HasSubstr("holds the points of the view's own cloud"));
}

TEST_F(FurtherClouds, OfALidarThatTheRigDoesNotHaveAreRefused) {
  EXPECT_THAT(ErrorOf("further_cloud { lidar: \"front\" file: \"cloud_rear.pcd\" }\n"),
              AllOf(HasSubstr("view.textproto:3"), HasSubstr("\"front\"")));
  EXPECT_THAT(ErrorOf("further_cloud { lidar: \"rear\" }\n"), HasSubstr("file is missing"));
  EXPECT_THAT(ErrorOf("further_cloud { lidar: \"rear\" file: \"none.pcd\" }\n"),
              HasSubstr("none.pcd"));
  const std::string rear = "further_cloud { lidar: \"rear\" file: \"cloud_rear.pcd\" }\n";
  EXPECT_THAT(ErrorOf(rear + rear), HasSubstr("second time"));
}

TEST(FurtherLidars, TheTruthHasTheirPoses) {
  const test::TempDir dir;
  Truth truth;
  truth.camera_from_lidar["rgb"] = test::MakePose(0.2, {1, 2, 3});
  truth.reference_from_lidar["rear"] = test::MakePose(-0.4, {-0.1, 0.5, 0.2});
  WriteTruth(dir / "truth.textproto", truth);
  const Truth back = ReadTruth(dir / "truth.textproto");
  ASSERT_EQ(back.reference_from_lidar.size(), 1U);
  test::ExpectSame(back.reference_from_lidar.at("rear"), truth.reference_from_lidar.at("rear"));
}

TEST(FurtherLidars, TheCalibrationHasTheirPosesWithCovarianceAndSaysWhichWayTheyGo) {
  const test::TempDir dir;
  const Calibration calibration = MakeReportOfTwo().ToCalibration();
  ASSERT_EQ(calibration.lidars.size(), 1U);
  WriteCalibration(dir / "calibration.textproto", calibration);
  const Calibration back = ReadCalibration(dir / "calibration.textproto");
  ASSERT_EQ(back.lidars.size(), 1U);
  EXPECT_EQ(back.lidars[0].lidar, "rear");
  test::ExpectSame(back.lidars[0].reference_from_lidar, calibration.lidars[0].reference_from_lidar);
  EXPECT_EQ(back.lidars[0].covariance, calibration.lidars[0].covariance);
  EXPECT_EQ(back.lidars[0].status, SolveStatus::kConverged);
  EXPECT_EQ(back.lidars[0].detail, "of a test");
  EXPECT_THAT(PrintCalibration(calibration),
              HasSubstr("point_in_reference = R(quaternion_wxyz) * point_in_lidar"));
  EXPECT_THAT(PrintCalibration(test::MakeReport().ToCalibration()),
              Not(HasSubstr("point_in_reference")));
}

TEST(FurtherLidars, OneThatWasNotSolvedIsInNoCalibration) {
  Report report = MakeReportOfTwo();
  report.lidars[0].calibration.status = SolveStatus::kNotSolved;
  EXPECT_THAT(report.ToCalibration().lidars, IsEmpty());
}

TEST(FurtherLidars, TheReportGivesBackWhatIsKnownOfThem) {
  const Report report = MakeReportOfTwo();
  const Report back = ReportFromJson(ReportToJson(report), "report.json");
  ASSERT_EQ(back.lidars.size(), 1U);
  const LidarReport& a = report.lidars[0];
  const LidarReport& b = back.lidars[0];
  EXPECT_EQ(b.calibration.lidar, "rear");
  test::ExpectSame(b.calibration.reference_from_lidar, a.calibration.reference_from_lidar);
  EXPECT_EQ(b.calibration.covariance, a.calibration.covariance);
  test::ExpectSame(*b.first_guess, *a.first_guess);
  EXPECT_EQ(b.used, a.used);
  ASSERT_EQ(b.rejected.size(), 1U);
  EXPECT_EQ(b.rejected[0].view, "0002");
  EXPECT_EQ(b.rejected[0].why, "the board moved");
  EXPECT_EQ(b.warnings, a.warnings);
  EXPECT_EQ(b.sigma->rotation_deg, a.sigma->rotation_deg);
  EXPECT_EQ(b.sigma->translation_mm, a.sigma->translation_mm);
  ASSERT_EQ(b.nuisance.size(), 1U);
  EXPECT_EQ(b.nuisance[0].estimate.sigma, 0.6);
  EXPECT_EQ(b.truth_error->rotation_deg, 0.012);
  EXPECT_EQ(ReportToJson(back), ReportToJson(report));
}

TEST(FurtherLidars, RosSeesThemInTheReferencesFrame) {
  const test::TempDir dir;
  const Calibration calibration = MakeReportOfTwo().ToCalibration();
  ExportUrdf(dir / "a.urdf", TwoLidars(), calibration);
  EXPECT_THAT(ReadWholeFile(dir / "a.urdf"),
              AllOf(HasSubstr("<link name=\"rear\"/>"), HasSubstr("<joint name=\"rear_joint\""),
                    HasSubstr("reference_from_lidar")));
  ExportRosStaticTransform(dir / "a.sh", TwoLidars(), calibration);
  EXPECT_THAT(ReadWholeFile(dir / "a.sh"), HasSubstr("--x -0.3 --y 0.35 --z 0.2"));
  EXPECT_THAT(ReadWholeFile(dir / "a.sh"), HasSubstr("--child-frame-id rear"));
  ExportUrdf(dir / "b.urdf", test::MakeRig(), test::MakeReport().ToCalibration());
  EXPECT_THAT(ReadWholeFile(dir / "b.urdf"), Not(HasSubstr("reference_from_lidar")));
}

}  // namespace
}  // namespace rgbdt
