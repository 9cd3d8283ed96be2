#include "calib/model/pose_sigma.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rgbdt {
namespace {

// A rotation by 1, 2 and 3 mrad and a centre by 4, 5 and 6 mm, along axes of no particular
// direction.
CameraCalibration Calibration() {
  Matrix6d covariance = Matrix6d::Zero();
  const Eigen::Matrix3d turn = RotationAbout({1, 2, 3}, 0.7).rotation.toRotationMatrix();
  const Eigen::Vector3d rotation(1e-3, 2e-3, 3e-3), centre(4e-3, 5e-3, 6e-3);
  covariance.topLeftCorner<3, 3>() =
      turn * rotation.array().square().matrix().asDiagonal() * turn.transpose();
  covariance.bottomRightCorner<3, 3>() =
      turn.transpose() * centre.array().square().matrix().asDiagonal() * turn;
  CameraCalibration calibration;
  calibration.camera_from_lidar = RotationAbout({0, 1, 0}, 0.4);
  calibration.covariance = covariance;
  return calibration;
}

TEST(WorstAxisSigma, IsThatOfTheAxisKnownLeastWhicheverItIs) {
  const auto sigma = WorstAxisSigma(Calibration());
  ASSERT_TRUE(sigma);
  EXPECT_NEAR(sigma->rotation_deg, 3e-3 * 180 / M_PI, 1e-9);
  EXPECT_NEAR(sigma->translation_mm, 6, 1e-6);
}

TEST(WorstAxisSigma, NothingWithoutACovariance) {
  CameraCalibration calibration = Calibration();
  (*calibration.covariance)(0, 0) = std::nan("");
  EXPECT_FALSE(WorstAxisSigma(calibration));
  calibration.covariance.reset();
  EXPECT_FALSE(WorstAxisSigma(calibration));
}

TEST(ChangeOf, IsInDegreesMillimetresAndSigmasOfTheFirst) {
  CameraCalibration from = Calibration();
  from.covariance = Matrix6d::Identity() * 1e-6;
  CameraCalibration to = from;
  Vector6d delta = Vector6d::Zero();
  delta[1] = 2e-3;
  to.camera_from_lidar = Exp(delta) * from.camera_from_lidar;
  const PoseChange change = ChangeOf(from, to);
  EXPECT_NEAR(change.difference.rotation_deg, 2e-3 * 180 / M_PI, 1e-9);
  EXPECT_NEAR(change.difference.translation_mm, 0, 1e-9);
  ASSERT_TRUE(change.sigmas);
  EXPECT_NEAR(*change.sigmas, 2, 1e-6);
  from.covariance.reset();
  EXPECT_FALSE(ChangeOf(from, to).sigmas);
}

}  // namespace
}  // namespace rgbdt
