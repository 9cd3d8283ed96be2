#include "calib/solve/internal/lens_check.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <random>

namespace rgbdt {
namespace {

// A lens of which data tell some numbers well, some a little and some nothing.
struct Told {
  LensCovariance prior =
      UsualLensUncertainty({Lens::Model::kPinhole, 900, 900, 640, 360, {}}, 1280, 720).covariance;
  LensCovariance information = LensCovariance::Zero();

  Told() {
    information.diagonal() << 4, 4, 1e-4, 1, 1e6, 0, 1e8, 0, 0;
    information(0, 1) = information(1, 0) = 1.5;
  }
  LensCovariance Posterior() const {
    return (LensCovariance(prior.inverse()) + information).inverse();
  }
  // What an estimate finds of a true lens: noise of the data, drawn towards the given lens.
  LensNumbers Estimate(const LensNumbers& truth, const LensNumbers& noise) const {
    const Eigen::LLT<LensCovariance> root(information + 1e-12 * LensCovariance::Identity());
    return Posterior() * (information * truth + root.matrixL() * noise);
  }
};

LensNumbers NormalNumbers(std::mt19937* random) {
  std::normal_distribution<double> normal;
  LensNumbers out;
  for (double& number : out) number = normal(*random);
  return out;
}

TEST(AgainstPrior, IsChiSquareWhereThePriorHolds) {
  constexpr int kDraws = 4000;
  const Told told;
  const LensCovariance root = told.prior.llt().matrixL();
  std::mt19937 random(3);
  double sum = 0;
  int freedom = 0;
  int alarms = 0;
  for (int i = 0; i < kDraws; ++i) {
    const LensNumbers truth = root * NormalNumbers(&random);
    const LensOff off =
        AgainstPrior(told.Estimate(truth, NormalNumbers(&random)), told.prior, told.Posterior());
    sum += off.chi2 / kDraws;
    freedom = off.freedom;
    alarms += off.contradicts() ? 1 : 0;
  }
  EXPECT_GT(freedom, 2);
  EXPECT_LT(freedom, kLensNumbers);
  EXPECT_NEAR(sum, freedom, 0.1 * freedom);
  EXPECT_LE(alarms, 4);
}

TEST(AgainstPrior, FindsALensThatIsFarOff) {
  const Told told;
  LensNumbers truth = LensNumbers::Zero();
  truth[0] = truth[1] = 0.04 * 900;  // eight sigmas
  const LensOff off =
      AgainstPrior(told.Estimate(truth, LensNumbers::Zero()), told.prior, told.Posterior());
  EXPECT_TRUE(off.contradicts());
  EXPECT_GT(off.chi2, 40);
}

TEST(AgainstPrior, SaysNothingOfAnExactLensOrWithoutData) {
  const Told told;
  EXPECT_FALSE(AgainstPrior(LensNumbers::Zero(), LensCovariance::Zero(), LensCovariance::Zero())
                   .contradicts());
  const LensOff none = AgainstPrior(LensNumbers::Zero(), told.prior, told.prior);
  EXPECT_EQ(none.freedom, 0);
  EXPECT_FALSE(none.contradicts());
}

}  // namespace
}  // namespace rgbdt
