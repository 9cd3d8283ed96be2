#include "calib/model/lens.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "calib/model/intrinsics.h"
#include "calib/model/rig.h"

namespace rgbdt {
namespace {

Lens Pinhole() {
  return {
      Lens::Model::kPinhole, 900, 905, 640, 360, {-0.1, 0.05, 1e-3, -2e-3, 0.01, 0.3, 0.2, 0.1}};
}

Lens Fisheye() { return {Lens::Model::kFisheye, 950, 951, 960, 600, {-0.05, -0.08, 0.1, -0.05}}; }

TEST(Lens, ItsNumbersAreItsNumbers) {
  for (const Lens& lens : {Pinhole(), Fisheye()}) {
    EXPECT_EQ(WithNumbers(lens, NumbersOf(lens)), lens);
    const LensNumbers other = NumbersOf(lens) + LensNumbers::Constant(0.5);
    EXPECT_EQ(NumbersOf(WithNumbers(lens, other)), other);
    EXPECT_NE(WithNumbers(lens, other), lens);
  }
  EXPECT_EQ(NamesOfNumbers(Lens::Model::kPinhole).size(), 9U);
  EXPECT_EQ(NamesOfNumbers(Lens::Model::kFisheye).size(), 8U);
}

TEST(UsualLensUncertainty, IsHalfAPercentOfTheFocalLengthAndOfWhatDistortionDoes) {
  const Lens lens = Fisheye();
  const LensCovariance c = UsualLensUncertainty(lens, 1920, 1200).covariance;
  EXPECT_NEAR(std::sqrt(c(0, 0)) / lens.fx, 0.005, 2e-4);
  EXPECT_NEAR(std::sqrt(c(2, 2)), 0.006 * 1920, 1e-9);
  // fx and fy go together.
  EXPECT_LT(std::sqrt(c(0, 0) + c(1, 1) - 2 * c(0, 1)) / lens.fx, 0.002);
  for (const double share : {0.3, 0.6, 1.0}) {
    const double angle = share * std::hypot(960, 600) / lens.fx;
    Eigen::Vector4d moves;  // a pixel there, in its distance from the middle
    for (int k = 0; k < 4; ++k) moves[k] = std::pow(angle, 2 * k + 2);
    const double sigma = std::sqrt(moves.dot(c.block<4, 4>(4, 4) * moves));
    EXPECT_GT(sigma, 0.001) << share;
    EXPECT_LT(sigma, 0.015) << share;
  }
  for (int k = 4; k < 8; ++k) EXPECT_GT(std::sqrt(c(k, k)), 0.02) << k;
}

TEST(UsualLensUncertainty, IsACovariance) {
  for (const Lens& lens : {Pinhole(), Fisheye()}) {
    const LensCovariance c = UsualLensUncertainty(lens, 1280, 720).covariance;
    EXPECT_TRUE(c.isApprox(c.transpose(), 1e-12));
    const Eigen::SelfAdjointEigenSolver<LensCovariance> eigen(c);
    EXPECT_GE(eigen.eigenvalues()[0], -1e-12 * eigen.eigenvalues()[8]);
    EXPECT_FALSE(UsualLensUncertainty(lens, 1280, 720).exact());
  }
  EXPECT_TRUE(LensUncertainty().exact());
  CameraSpec camera;
  camera.width = 1280;
  camera.height = 720;
  camera.lens = Pinhole();
  EXPECT_FALSE(camera.LensUncertaintyOrUsual().exact());
  camera.lens_uncertainty = LensUncertainty();
  EXPECT_TRUE(camera.LensUncertaintyOrUsual().exact());
}

TEST(MiddleOf, LeavesOutWhatWasNotSeen) {
  EXPECT_EQ(MiddleOf({{1, 2}, {NAN, NAN}, {3, 6}}), Eigen::Vector2d(2, 4));
}

// k4, k5 and k6 are taken as known, so the others' covariance is the one given them: the inverse of
// their part of the information.
TEST(UncertaintyOf, TakesTheHigherTermsAsKnown) {
  IntrinsicsResult result;
  Eigen::MatrixXd root = Eigen::MatrixXd::Identity(12, 12);
  for (int i = 0; i < 144; ++i) root(i / 12, i % 12) += 0.2 * std::sin(i * i + 1.0);
  result.covariance = root * root.transpose();
  result.views.resize(2);
  result.views[1].rejected = "moved";
  const std::vector<IntrinsicsView> views = {{"a", {{1, 1}, {3, 5}}}, {"b", {{7, 7}, {9, 9}}}};
  const LensUncertainty uncertainty = UncertaintyOf(result, views);
  const Eigen::MatrixXd information = result.covariance.inverse();
  const LensCovariance given = information.topLeftCorner<9, 9>().inverse();
  EXPECT_LT((uncertainty.covariance - given).norm(), 1e-9 * given.norm());
  ASSERT_EQ(uncertainty.made_from.size(), 1U);
  EXPECT_EQ(uncertainty.made_from[0], Eigen::Vector2d(2, 3));
}

}  // namespace
}  // namespace rgbdt
