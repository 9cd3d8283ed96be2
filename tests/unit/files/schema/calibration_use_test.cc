#include "calib/files/schema/calibration_use.h"

#include "calib/files/schema/calibration_file.h"
#include "calib/files/schema/rig_file.h"
#include "tests/unit/files/test_data.h"

namespace rgbdt {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

const UseNames kNames = {"old/calibration.textproto", "new/rig.textproto"};

// As a person's file has it, so that it has a hash.
Rig Read(const Rig& rig, const std::string& comment = "") {
  return ParseRig(comment + PrintRig(rig), "rig.textproto");
}

// Made with this rig, as it is read back from its file.
Calibration CalibrationOf(const Rig& rig) {
  const test::TempDir dir;
  Calibration calibration = test::MakeReport().ToCalibration();
  calibration.rig_hash = rig.hash;
  calibration.sensors = SensorsOf(rig);
  for (CameraCalibration& camera : calibration.cameras) {
    camera.status = SolveStatus::kConverged;
    camera.detail.clear();
  }
  WriteCalibration(dir / "c", calibration);
  return ReadCalibration(dir / "c");
}

TEST(CalibrationUse, OfItsOwnRigItIsTaken) {
  const Rig rig = Read(test::MakeRig());
  EXPECT_THAT(RequireSound(CalibrationOf(rig), rig, kNames, Use::kIfSound), IsEmpty());
}

TEST(CalibrationUse, WhatMovesNoCameraDoesNotCount) {
  const Rig rig = Read(test::MakeRig());
  Rig other = test::MakeRig();
  other.name = other.lidar.name = "renamed";
  other.lidar.device = VelodyneDevice{VelodyneDevice::Model::kVlp16, 2370, ""};
  other.lidar.range_sigma_m *= 2;
  other.target.square_m *= 1.1;
  other.cameras[0].device.emplace().address = "192.168.1.7";
  other.cameras[0].camera_from_lidar_guess.reset();
  other.cameras[0].readout_s += 0.1;
  std::swap(other.cameras[0], other.cameras[1]);
  const Rig read = Read(other, "# by hand\n");
  ASSERT_NE(read.hash, rig.hash);
  EXPECT_EQ(WhyAnotherRig(CalibrationOf(rig), read, kNames), "");
}

TEST(CalibrationUse, ALidarOfAnotherNameIsToldWhereItIsUsed) {
  const Rig rig = Read(test::MakeRig());
  EXPECT_THAT(DoubtsOf(CalibrationOf(rig), rig, "c"), IsEmpty());
  Rig other = test::MakeRig();
  other.lidar.name = "os0";
  EXPECT_THAT(DoubtsOf(CalibrationOf(rig), Read(other), "c"),
              ElementsAre(AllOf(HasSubstr("with LIDAR " + rig.lidar.name), HasSubstr("is os0"))));
  EXPECT_THAT(RequireSound(CalibrationOf(rig), Read(other), kNames, Use::kIfSound), IsEmpty());
}

Rig WithRear() {
  Rig rig = test::MakeRig();
  rig.further_lidars.emplace_back().name = "rear";
  return rig;
}

TEST(CalibrationUse, WhichLidarIsTheReferenceCountsWhereThereAreSeveral) {
  const Rig rig = Read(WithRear());
  Rig exchanged = WithRear();
  std::swap(exchanged.lidar, exchanged.further_lidars[0]);
  EXPECT_THAT(WhyAnotherRig(CalibrationOf(rig), Read(exchanged), kNames),
              HasSubstr("the first lidar, in whose frame all is"));
}

TEST(CalibrationUse, ALidarThatWasCalibratedIsToBeThereAndOneThatWasNotDoesNotCount) {
  const Rig one = Read(test::MakeRig());
  const Rig two = Read(WithRear());
  EXPECT_EQ(WhyAnotherRig(CalibrationOf(one), two, kNames), "");
  EXPECT_EQ(WhyAnotherRig(CalibrationOf(two), one, kNames), "");
  Calibration calibration = CalibrationOf(two);
  calibration.lidars = {{"rear", {}, Matrix6d::Identity(), SolveStatus::kConverged}};
  EXPECT_EQ(WhyAnotherRig(calibration, Read(WithRear(), "# by hand\n"), kNames), "");
  EXPECT_THAT(WhyAnotherRig(calibration, one, kNames), HasSubstr("lidar rear: not among"));
}

TEST(CalibrationUse, AFurtherLidarsPoseThatIsNotToBeUsedSpeaksAgainstItWhereItIsUsed) {
  const Rig rig = Read(WithRear());
  Calibration calibration = CalibrationOf(rig);
  calibration.lidars = {{"rear", {}, Matrix6d::Identity(), SolveStatus::kDegenerate, "too loose"}};
  EXPECT_THAT(RequireSound(calibration, rig, kNames, Use::kAnyway), IsEmpty());
  EXPECT_THAT(RequireSound(calibration, rig, kNames, Use::kAnyway, Further::kUsed),
              ElementsAre(HasSubstr("the pose of LIDAR rear is not to be used")));
}

TEST(CalibrationUse, WhatDiffersIsSaidFieldByField) {
  const Rig rig = Read(test::MakeRig());
  Rig other = test::MakeRig();
  other.cameras[0].lens.fx = 1300;
  other.cameras[1].width -= 1;
  other.lidar.turned_scanner->zero_ticks = 5;
  const Calibration calibration = CalibrationOf(rig);
  EXPECT_THAT(
      SensorDifferences(calibration, Read(other)),
      ElementsAre("lidar.turned_scanner.zero_ticks: -77.5 -> 5",
                  AllOf(HasSubstr("camera rgb: "), HasSubstr(".fx: "), HasSubstr(" -> 1300")),
                  HasSubstr("camera thermal: width: ")));
  const std::string why = WhyAnotherRig(calibration, Read(other), kNames);
  EXPECT_THAT(why, AllOf(HasSubstr("old/calibration.textproto was made with another rig than "
                                   "new/rig.textproto"),
                         HasSubstr("zero_ticks"), HasSubstr("camera rgb"), HasSubstr("--anyway"),
                         Not(HasSubstr("\n"))));
  EXPECT_EQ(test::ErrorOf([&] { RequireSound(calibration, Read(other), kNames, Use::kIfSound); }),
            why);
  EXPECT_THAT(RequireSound(calibration, Read(other), kNames, Use::kAnyway), ElementsAre(why));
}

TEST(CalibrationUse, AnotherLensModelOrLidarIsAnotherRig) {
  Rig rig = test::MakeRig();
  rig.lidar.turned_scanner.reset();
  rig.lidar.device = VelodyneDevice{VelodyneDevice::Model::kVlp16, 2368, ""};
  const Calibration calibration = CalibrationOf(Read(rig));
  Rig other = rig;
  std::get<VelodyneDevice>(other.lidar.device).model = VelodyneDevice::Model::kHdl32e;
  EXPECT_THAT(SensorDifferences(calibration, Read(other)),
              ElementsAre("lidar.velodyne.model: VLP16 -> HDL32E"));
  other = rig;
  other.lidar.turned_scanner = test::MakeRig().lidar.turned_scanner;
  EXPECT_THAT(SensorDifferences(calibration, Read(other)), Not(IsEmpty()));
  other = rig;
  other.cameras[0].lens.model = Lens::Model::kFisheye;
  other.cameras[0].lens.distortion = {};
  EXPECT_THAT(WhyAnotherRig(calibration, Read(other), kNames),
              AllOf(HasSubstr("camera rgb: pinhole"), HasSubstr("camera rgb: fisheye")));
}

// A camera more is one that was not calibrated; one fewer, or under another name, is missed.
TEST(CalibrationUse, OnlyCalibratedCamerasCount) {
  const Rig rig = Read(test::MakeRig());
  Calibration calibration = CalibrationOf(rig);
  Rig other = test::MakeRig();
  other.cameras.push_back(other.cameras[0]);
  other.cameras.back().name = "third";
  EXPECT_EQ(WhyAnotherRig(calibration, Read(other), kNames), "");
  other.cameras.erase(other.cameras.begin());
  EXPECT_THAT(WhyAnotherRig(calibration, Read(other), kNames),
              HasSubstr("camera rgb: not in the rig"));
  calibration.cameras.erase(calibration.cameras.begin());
  EXPECT_EQ(WhyAnotherRig(calibration, Read(other), kNames), "");
}

TEST(CalibrationUse, AFileOfBeforeHasOnlyTheHash) {
  const Rig rig = Read(test::MakeRig());
  Calibration calibration = CalibrationOf(rig);
  calibration.sensors.reset();
  EXPECT_EQ(WhyAnotherRig(calibration, rig, kNames), "");
  const Rig commented = Read(test::MakeRig(), "# by hand\n");
  EXPECT_THAT(WhyAnotherRig(calibration, commented, kNames),
              AllOf(HasSubstr(rig.hash + " -> " + commented.hash), HasSubstr("is not known"),
                    HasSubstr("--anyway")));
  calibration.rig_hash.clear();  // written by hand
  EXPECT_EQ(WhyAnotherRig(calibration, commented, kNames), "");
}

TEST(CalibrationUse, WhatIsNotToBeUsedIsRefusedWithItsReason) {
  const Rig rig = Read(test::MakeRig());
  Calibration calibration = CalibrationOf(rig);
  CameraCalibration& camera = calibration.cameras[1];
  for (const SolveStatus status :
       {SolveStatus::kNotSolved, SolveStatus::kUndetermined, SolveStatus::kNotConverged,
        SolveStatus::kDegenerate, SolveStatus::kContradicted}) {
    camera.status = status;
    camera.detail = "Likeliest cause: the squares.";
    const std::string why =
        test::ErrorOf([&] { RequireSound(calibration, rig, kNames, Use::kIfSound); });
    EXPECT_THAT(why,
                AllOf(HasSubstr("old/calibration.textproto: the calibration of camera thermal "
                                "is not to be used: "),
                      HasSubstr("Likeliest cause: the squares. Fix that"), HasSubstr("--anyway")));
    EXPECT_THAT(RequireSound(calibration, rig, kNames, Use::kAnyway), ElementsAre(why));
    EXPECT_THAT(RequireSameRig(calibration, rig, kNames, Use::kIfSound), IsEmpty());
  }
  camera.status = SolveStatus::kFirstGuessKept;
  EXPECT_THAT(RequireSound(calibration, rig, kNames, Use::kIfSound), IsEmpty());
}

TEST(CalibrationUse, AnywayAllIsSaid) {
  Calibration calibration = CalibrationOf(Read(test::MakeRig()));
  for (CameraCalibration& camera : calibration.cameras) camera.status = SolveStatus::kDegenerate;
  Rig other = test::MakeRig();
  other.cameras[0].lens.cy += 1;
  EXPECT_THAT(RequireSound(calibration, Read(other), kNames, Use::kAnyway), SizeIs(3));
}

TEST(CalibrationUse, AReportThatIsRefusedShowsNoPose) {
  const Report report = WithoutPoses(test::MakeReport(), "another rig");
  EXPECT_THAT(report.ToCalibration().cameras, IsEmpty());
  for (const CameraReport& camera : report.cameras) {
    EXPECT_THAT(camera.calibration.StatusText(), HasSubstr("another rig"));
  }
}

}  // namespace
}  // namespace rgbdt
