#include "calib/files/schema/calibration_file.h"

#include <array>
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
  calibration.cameras[1].range_errors = test::MakeRangeErrors();
  calibration.cameras[1].timing = CameraTiming{{-0.0123, 1e-4}, {0.021, 2e-5}};
  WriteCalibration(dir / "calibration.textproto", calibration);
  const Calibration back = ReadCalibration(dir / "calibration.textproto");
  EXPECT_EQ(ReadCalibration(dir.path()).cameras.size(), back.cameras.size()) << "its directory's";
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
    EXPECT_TRUE(b.range_errors == a.range_errors);
    EXPECT_TRUE(b.timing == a.timing);
  }
  EXPECT_FALSE(back.cameras[0].range_errors);
  EXPECT_EQ(back.cameras[1].lens->lens, lens.lens);
  EXPECT_EQ(back.cameras[1].lens->covariance, lens.covariance);
  EXPECT_EQ(PrintCalibration(back), PrintCalibration(calibration));
}

TEST(CalibrationFile, ACovarianceThatIsNoneIsRefused) {
  const test::TempDir dir;
  Calibration calibration = test::MakeReport().ToCalibration();
  const auto write = [&](double first, double off_diagonal, double mirrored) {
    Matrix6d covariance = Matrix6d(Vector6d::Constant(1e-6).asDiagonal());
    covariance(0, 0) = first;
    covariance(1, 2) = off_diagonal;
    covariance(2, 1) = mirrored;
    calibration.cameras[0].covariance = covariance;
    WriteCalibration(dir / "c", calibration);
  };
  for (const auto& [first, off_diagonal, mirrored] :
       {std::array{-1e-6, 0., 0.}, std::array{1e-6, 2e-6, 2e-6}, std::array{1e-6, 5e-7, -5e-7}}) {
    write(first, off_diagonal, mirrored);
    EXPECT_THAT(test::ErrorOf([&] { ReadCalibration(dir / "c"); }), HasSubstr("is no covariance"));
  }
  write(1e-6, 9.99e-7, 9.99e-7);
  EXPECT_NO_THROW(ReadCalibration(dir / "c"));
}

TEST(CalibrationFile, KeepsWhatItHoldsFor) {
  const test::TempDir dir;
  Calibration calibration = test::MakeReport().ToCalibration();
  const Rig rig = test::MakeRig();
  calibration.sensors = SensorsOf(rig);
  WriteCalibration(dir / "c", calibration);
  const Calibration back = ReadCalibration(dir / "c");
  ASSERT_TRUE(back.sensors);
  EXPECT_EQ(back.sensors->cameras.at(1).lens, rig.cameras[1].lens);
  EXPECT_EQ(back.sensors->cameras[1].width, rig.cameras[1].width);
  EXPECT_EQ(back.sensors->lidar.turned_scanner->zero_ticks, rig.lidar.turned_scanner->zero_ticks);
  EXPECT_EQ(back.sensors->target.width_m, 0) << "it does not depend on the board";
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

TEST(CalibrationFile, RangeErrorsThatMakeNoSenseAreRefused) {
  const test::TempDir dir;
  Calibration calibration = test::MakeReport().ToCalibration();
  calibration.cameras.resize(1);
  calibration.cameras[0].range_errors = test::MakeRangeErrors();
  const auto error = [&](auto change) {
    Calibration changed = calibration;
    change(&*changed.cameras[0].range_errors);
    WriteCalibration(dir / "c", changed);
    return test::ErrorOf([&] { ReadCalibration(dir / "c"); });
  };
  using Errors = RangeErrors*;
  EXPECT_THAT(error([](Errors e) { e->rings[0].ring = -1; }),
              HasSubstr("camera.range_errors.ring.ring is -1; expected numbers from 0"));
  EXPECT_THAT(error([](Errors e) { e->rings[2].ring = 256; }), HasSubstr("ring.ring is 256"));
  EXPECT_THAT(error([](Errors e) { e->rings[1].ring = 0; }), HasSubstr("ring.ring is 0"));
  EXPECT_THAT(error([](Errors e) { e->intensities[0].log2_intensity = -16.5; }),
              HasSubstr("camera.range_errors.intensity.log2_intensity is -16.5"));
  EXPECT_THAT(error([](Errors e) {
                e->intensities = {{0.5, {}}};
              }),
              HasSubstr("intensity.log2_intensity is 0.5"));
  EXPECT_THAT(error([](Errors e) { e->intensities[1].log2_intensity = -1.3; }),
              HasSubstr("intensity.log2_intensity is -1.3"));
  // What is not finite is not written, and missed when it is read.
  EXPECT_THAT(error([](Errors e) { e->offset_m.value = INFINITY; }),
              HasSubstr("camera.range_errors.offset_m.value is nan"));
  EXPECT_THAT(error([](Errors e) { e->beams_meet_m.sigma = NAN; }),
              HasSubstr("camera.range_errors.beams_meet_m.sigma is nan"));
  EXPECT_THAT(error([](Errors e) { e->rings[2].offset_m.value = NAN; }),
              HasSubstr("camera.range_errors.ring.offset_m.value is nan"));
  EXPECT_THAT(error([](Errors e) { e->intensities[0].offset_m.sigma = NAN; }),
              HasSubstr("camera.range_errors.intensity.offset_m.sigma is nan"));
  EXPECT_THAT(error([](Errors e) { e->offset_m.sigma = -0.5; }),
              HasSubstr("camera.range_errors.offset_m.sigma is -0.5"));
}

TEST(CalibrationFile, DamagedTextNeverCrashes) {
  const test::TempDir dir;
  const auto parse = [&](const std::string& text) {
    test::WriteQuickly(dir / "c", text);
    ReadCalibration(dir / "c");
  };
  Calibration calibration = test::MakeReport().ToCalibration();
  calibration.cameras[0].range_errors = test::MakeRangeErrors();
  const std::string text = PrintCalibration(calibration);
  test::ParseTruncations(text, parse, 100);
  test::ParseDamaged(text, parse, 60);
}

}  // namespace
}  // namespace rgbdt
