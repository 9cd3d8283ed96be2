#include "calib/files/schema/calibration_file.h"

#include <cmath>

#include "calib/files/atomic_file.h"
#include "tests/unit/files/test_data.h"

namespace rgbdt {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(CalibrationFile, GivesBackEveryBit) {
  const test::TempDir dir;
  Calibration calibration = test::MakeReport().ToCalibration();
  SolvedLens& lens = calibration.cameras[1].lens.emplace();
  lens.lens = {Lens::Model::kFisheye, 500.1, 501.2, 320.3, 240.4, {0.1, -0.2, 0.3, -0.4}};
  for (int i = 0; i < lens.covariance.size(); ++i) lens.covariance(i / 15, i % 15) = std::sin(i);
  WriteCalibration(dir / "calibration.textproto", calibration);
  const Calibration back = ReadCalibration(dir / "calibration.textproto");
  EXPECT_EQ(back.method, calibration.method);
  EXPECT_EQ(back.rig_hash, calibration.rig_hash);
  EXPECT_EQ(back.utime, calibration.utime);
  ASSERT_EQ(back.cameras.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    const CameraCalibration& a = calibration.cameras[i];
    const CameraCalibration& b = back.cameras[i];
    EXPECT_EQ(b.camera, a.camera);
    test::ExpectSame(b.camera_from_lidar, a.camera_from_lidar);
    EXPECT_EQ(b.covariance, a.covariance);
    EXPECT_EQ(b.status, a.status);
    EXPECT_EQ(b.detail, a.detail);
    ASSERT_EQ(b.lens.has_value(), a.lens.has_value());
  }
  EXPECT_EQ(back.cameras[1].lens->lens, lens.lens);
  EXPECT_EQ(back.cameras[1].lens->covariance, lens.covariance);
  EXPECT_EQ(PrintCalibration(back), PrintCalibration(calibration));
}

TEST(CalibrationFile, SaysWhichWayTheTransformGoes) {
  const std::string text = PrintCalibration(test::MakeReport().ToCalibration());
  EXPECT_THAT(text, StartsWith("# "));
  EXPECT_THAT(text, HasSubstr("point_in_camera = R(quaternion_wxyz) * point_in_lidar + "));
}

TEST(CalibrationFile, WritesANormalisedQuaternion) {
  Calibration calibration = test::MakeReport().ToCalibration();
  const Rigid3 pose = calibration.cameras[0].camera_from_lidar;
  calibration.cameras[0].camera_from_lidar.rotation.coeffs() *= 7;
  const test::TempDir dir;
  WriteCalibration(dir / "c", calibration);
  const Rigid3 back = ReadCalibration(dir / "c").cameras[0].camera_from_lidar;
  EXPECT_NEAR(back.rotation.norm(), 1, 1e-15);
  EXPECT_LT(RotationDistance(back, pose), 1e-12);
}

TEST(CalibrationFile, ErrorsNameLineAndKey) {
  const test::TempDir dir;
  const auto error = [&](const std::string& text) {
    WriteFileAtomically(dir / "c.textproto", text);
    return test::ErrorOf([&] { ReadCalibration(dir / "c.textproto"); });
  };
  EXPECT_THAT(error("method: \"paper\"\n"), HasSubstr("camera is missing"));
  EXPECT_THAT(error("camera {\n  name: \"rgb\" }"), HasSubstr("c.textproto:2:"));
  EXPECT_THAT(
      error("camera {\n camera: \"rgb\"\n camera_from_lidar { translation_m: [0, 0, 0] } }"),
      HasSubstr("c.textproto:3: camera.camera_from_lidar.quaternion_wxyz has 0"));
  const std::string one =
      "camera { camera: \"rgb\" camera_from_lidar {\n"
      " quaternion_wxyz: [1, 0, 0, 0] translation_m: [0, 0, 0] } }\n";
  EXPECT_THAT(error(one + one),
              HasSubstr("c.textproto:3: camera.camera is \"rgb\" for the second"));
}

TEST(CalibrationFile, DamagedTextNeverCrashes) {
  const test::TempDir dir;
  const auto parse = [&](const std::string& text) {
    test::WriteQuickly(dir / "c", text);
    ReadCalibration(dir / "c");
  };
  const std::string text = PrintCalibration(test::MakeReport().ToCalibration());
  test::ParseTruncations(text, parse, 100);
  test::ParseDamaged(text, parse, 60);
}

}  // namespace
}  // namespace rgbdt
