#include "calib/solve/compare.h"

#include <cmath>
#include <limits>

#include "calib/model/linear_algebra.h"
#include "tests/numbers.h"
#include "tests/unit/matchers.h"

namespace rgbdt {
namespace {

CameraSpec Spec() {
  CameraSpec spec;
  spec.name = "rgb";
  spec.width = 640;
  spec.height = 480;
  spec.lens.fx = spec.lens.fy = 500;
  spec.lens.cx = 319.5;
  spec.lens.cy = 239.5;
  return spec;
}

// The camera looks along the LIDAR's x.
CameraCalibration Somewhere() {
  Eigen::Matrix3d rotation;
  rotation << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  CameraCalibration calibration;
  calibration.camera = "rgb";
  calibration.status = SolveStatus::kConverged;
  calibration.camera_from_lidar = {Eigen::Quaterniond(rotation), {0.1, -0.2, 0.05}};
  calibration.covariance = Matrix6d((Vector6d() << 1e-4, 2e-4, 3e-4, 1e-3, 2e-3, 3e-3)
                                        .finished()
                                        .array()
                                        .square()
                                        .matrix()
                                        .asDiagonal());
  return calibration;
}

// By 0.4 degrees about the camera's y.
CameraCalibration TurnedAboutY(CameraCalibration calibration) {
  calibration.camera_from_lidar =
      RotationAbout({0, 1, 0}, 0.4 * kDegree) * calibration.camera_from_lidar;
  return calibration;
}

TEST(Compare, ACalibrationWithItselfIsTheSame) {
  const CameraSpec spec = Spec();
  const PoseComparison same = Compare(Somewhere(), Somewhere(), &spec);
  EXPECT_NEAR(same.chi2.value(), 0, 1e-12);
  ASSERT_EQ(same.pixels.size(), 3U);
  for (const PixelShift& at : same.pixels) EXPECT_NEAR(at.rms_px, 0, 1e-6);
  EXPECT_EQ(ChanceOfChi2(0), 1);
}

// What moves both poses alike is no change.
TEST(Compare, WhatTwoPosesHaveInCommonCancels) {
  const CameraSpec spec = Spec();
  const CameraCalibration a = Somewhere();
  const CameraCalibration b = TurnedAboutY(a);
  const PoseComparison apart = Compare(a, b, &spec);
  const Matrix6d common = 0.75 * *a.covariance;
  const PoseComparison together = Compare(a, b, &spec, common);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(together.rotation_deg[k].value, apart.rotation_deg[k].value);
    EXPECT_NEAR(together.rotation_deg[k].sigma, apart.rotation_deg[k].sigma / 2,
                0.02 * apart.rotation_deg[k].sigma);
    EXPECT_NEAR(together.centre_mm[k].sigma, apart.centre_mm[k].sigma / 2,
                0.02 * apart.centre_mm[k].sigma);
  }
  EXPECT_NEAR(*together.chi2, 4 * *apart.chi2, 0.1 * *apart.chi2);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(together.pixels[k].rms_px, apart.pixels[k].rms_px);
    EXPECT_NEAR(*together.pixels[k].sigma_px, *apart.pixels[k].sigma_px / 2,
                0.03 * *apart.pixels[k].sigma_px);
  }
}

TEST(Compare, SaysWhatMovedInWhichAxes) {
  const CameraSpec spec = Spec();
  const CameraCalibration a = Somewhere();
  CameraCalibration b = TurnedAboutY(a);
  const PoseComparison turned = Compare(a, b, &spec);
  EXPECT_NEAR(turned.rotation_deg[0].value, 0, 1e-9);
  EXPECT_NEAR(turned.rotation_deg[1].value, 0.4, 1e-9);
  EXPECT_NEAR(turned.rotation_deg[1].sigma, std::sqrt(2.0) * 2e-4 / kDegree, 1e-6);
  // In the middle of the image a turn of 7 mrad is 3.5 px, at any distance; in its corners more.
  EXPECT_GT(turned.pixels[1].rms_px, 500 * 0.4 * kDegree);
  EXPECT_LT(turned.pixels[1].rms_px, 1.3 * 500 * 0.4 * kDegree);
  EXPECT_NEAR(turned.pixels[2].rms_px, turned.pixels[0].rms_px, 1e-6);

  // The camera 10 mm farther along the LIDAR's z, its own -y.
  b.camera_from_lidar = a.camera_from_lidar;
  b.camera_from_lidar.translation.y() += 0.01;
  const PoseComparison lifted = Compare(a, b, &spec);
  EXPECT_NEAR(lifted.centre_mm[0].value, 0, 1e-9);
  EXPECT_NEAR(lifted.centre_mm[2].value, 10, 1e-9);
  EXPECT_NEAR(lifted.centre_mm[2].sigma, std::sqrt(2.0) * 2, 1e-9);
  EXPECT_NEAR(lifted.difference.translation_mm, 10, 1e-9);
  EXPECT_NEAR(lifted.pixels[0].rms_px, 500 * 0.01 / 2, 1);
  EXPECT_NEAR(lifted.pixels[0].rms_px, 5 * lifted.pixels[2].rms_px, 0.1);
}

TEST(Compare, WithoutCovarianceOrLensItSaysNothingOfThem) {
  const CameraCalibration a = Somewhere();
  CameraCalibration b = a;
  b.covariance.reset();
  const PoseComparison comparison = Compare(a, b, nullptr);
  EXPECT_FALSE(comparison.chi2);
  EXPECT_TRUE(std::isnan(comparison.rotation_deg[0].sigma));
  EXPECT_TRUE(comparison.pixels.empty());
}

TEST(Compare, WhatDidNotConvergeOrHasNoProperCovarianceIsNotCalledTheSame) {
  const CameraCalibration a = Somewhere();
  CameraCalibration b = a;
  b.status = SolveStatus::kNotConverged;
  EXPECT_FALSE(Compare(a, b, nullptr).chi2);
  EXPECT_FALSE(Compare(b, a, nullptr).chi2);
  for (const double variance : {-1.0, std::numeric_limits<double>::quiet_NaN()}) {
    b = a;
    (*b.covariance)(4, 4) = variance;
    const PoseComparison comparison = Compare(a, b, nullptr);
    EXPECT_FALSE(comparison.chi2);
    EXPECT_TRUE(std::isnan(comparison.centre_mm[0].sigma));
  }
}

// Two estimates of one truth, each drawn from its covariance, far from the axes' diagonal.
TEST(Compare, ChiSquareOfEstimatesOfOneTruthIsThatOfSixDegreesOfFreedom) {
  constexpr int kTrials = 4000;
  const CameraSpec spec = Spec();
  Random random(11);
  const auto draw = [&](const Matrix6d& covariance) {
    const auto [values, vectors] = EigensystemOf(covariance);
    Vector6d error = Vector6d::Zero();
    for (int k = 0; k < 6; ++k) {
      double normal = -6;
      for (int i = 0; i < 12; ++i) normal += random.Uniform(0, 1);
      error += normal * std::sqrt(values[k]) * vectors.col(k);
    }
    return error;
  };
  CameraCalibration truth = Somewhere();
  std::srand(5);
  const auto any = [] {
    const Matrix6d root = 1e-3 * Matrix6d::Random();
    return Matrix6d(root * root.transpose() + 1e-8 * Matrix6d::Identity());
  };
  CameraCalibration a = truth, b = truth;
  a.covariance = any();
  b.covariance = any();
  double sum = 0, by_chance = 0;
  double squares = 0, variance = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    // truth = Exp(error) * estimate
    a.camera_from_lidar = Exp(-draw(*a.covariance)) * truth.camera_from_lidar;
    b.camera_from_lidar = Exp(-draw(*b.covariance)) * truth.camera_from_lidar;
    const bool with_pixels = trial < 400;
    const PoseComparison comparison = Compare(a, b, with_pixels ? &spec : nullptr);
    sum += *comparison.chi2;
    by_chance += ChanceOfChi2(*comparison.chi2) < 0.01 ? 1 : 0;
    if (!with_pixels) continue;
    squares += std::pow(comparison.pixels[1].rms_px, 2);
    variance += std::pow(*comparison.pixels[1].sigma_px, 2);
  }
  EXPECT_NEAR(sum / kTrials, 6, 3.3 * std::sqrt(12.0 / kTrials));
  EXPECT_NEAR(by_chance / kTrials, 0.01, 3.3 * std::sqrt(0.01 / kTrials));
  EXPECT_NEAR(squares / variance, 1, 3.3 * std::sqrt(2.0 / 400));  // of one degree of freedom
}

TEST(ChanceOfChi2, IsTheSurvivalFunctionOfSixDegreesOfFreedom) {
  EXPECT_NEAR(ChanceOfChi2(12.592), 0.05, 1e-5);  // tables
  EXPECT_NEAR(ChanceOfChi2(16.812), 0.01, 1e-5);
  EXPECT_NEAR(ChanceOfChi2(22.458), 0.001, 1e-6);
}

}  // namespace
}  // namespace rgbdt
