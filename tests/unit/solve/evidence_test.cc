#include "calib/solve/internal/evidence.h"

#include <gtest/gtest.h>

#include <cmath>

#include "calib/model/linear_algebra.h"
#include "tests/unit/matchers.h"

namespace rgbdt {
namespace {

class Normals {
 public:
  explicit Normals(std::uint32_t seed) : random_(seed) {}
  double Normal() {  // Box and Muller; the standard's distribution differs between libraries
    return std::sqrt(-2 * std::log(random_.Uniform(1e-12, 1))) *
           std::cos(2 * M_PI * random_.Uniform(0, 1));
  }

 private:
  Random random_;
};

// Unknowns of this sigma, each measured with noise of its own: what the measurements say of them.
struct Measured {
  Eigen::MatrixXd information;
  Eigen::VectorXd gradient;

  Measured(int count, double sigma, std::uint32_t seed)
      : information(Eigen::MatrixXd::Zero(count, count)), gradient(count) {
    Normals random(seed);
    for (int i = 0; i < count; ++i) {
      const double noise = 0.001 * (1 + i % 3);
      const double value = sigma * random.Normal() + noise * random.Normal();
      information(i, i) = 1 / (noise * noise);
      gradient[i] = value / (noise * noise);
    }
  }
};

TEST(MostLikelySigma, IsThatOfTheUnknowns) {
  double log_sum = 0;
  constexpr int kRuns = 50;
  for (std::uint32_t seed = 1; seed <= kRuns; ++seed) {
    const Measured measured(40, 0.008, seed);
    const Evidence evidence = MostLikelySigma(measured.information, measured.gradient, 1e-4, 0.1);
    EXPECT_NEAR(std::log(evidence.sigma / 0.008), 0, 0.5) << seed;
    EXPECT_GT(evidence.gain, 14);
    log_sum += std::log(evidence.sigma / 0.008);
  }
  EXPECT_NEAR(log_sum / kRuns, 0, 0.05);
}

TEST(MostLikelySigma, IsNothingWhereNoiseIsAllThereIs) {
  int gained = 0;
  for (std::uint32_t seed = 1; seed <= 200; ++seed) {
    const Measured measured(16, 0, seed);
    const Evidence evidence = MostLikelySigma(measured.information, measured.gradient, 1e-4, 0.1);
    EXPECT_GE(evidence.gain, 0);
    EXPECT_LT(evidence.gain, 13.8) << seed;
    gained += evidence.gain > 2.7 ? 1 : 0;  // one in twenty
  }
  EXPECT_LT(gained, 25);
}

TEST(MostLikelySigma, UnknownsMayShareWhatIsSaidOfThem) {
  // The same of their sums and differences.
  const Measured apart(2, 0.01, 3);
  Eigen::Matrix2d turn;
  turn << 0.6, -0.8, 0.8, 0.6;
  const Evidence a = MostLikelySigma(apart.information, apart.gradient, 1e-4, 0.1);
  const Evidence b = MostLikelySigma(turn * apart.information * turn.transpose(),
                                     turn * apart.gradient, 1e-4, 0.1);
  EXPECT_NEAR(a.sigma, b.sigma, 1e-12);
  EXPECT_NEAR(a.gain, b.gain, 1e-9);
}

TEST(Marginal, IsWhatTheWholeSaysOfAPart) {
  Normals random(2);
  Eigen::MatrixXd root(6, 6);
  for (Eigen::Index i = 0; i < root.size(); ++i) root.data()[i] = random.Normal();
  ViewInformation all{root * root.transpose() + Eigen::MatrixXd::Identity(6, 6),
                      Eigen::VectorXd(6)};
  for (double& g : all.gradient) g = random.Normal();
  const std::vector<Eigen::Index> kept{4, 1};
  const ViewInformation part = Marginal(all, kept, {0, 2, 3, 5});
  const Eigen::MatrixXd covariance = InverseOfSymmetric(all.information);
  const Eigen::VectorXd best = covariance * all.gradient;
  EXPECT_LT((InverseOfSymmetric(part.information) - covariance(kept, kept)).norm(), 1e-12);
  EXPECT_LT((SolveSymmetric(part.information, part.gradient) - best(kept)).norm(), 1e-12);
}

TEST(ScatterBeyond, IsWhatTheVariancesDoNotExplain) {
  constexpr int kRuns = 20;
  for (const double sigma : {0.002, 0.010}) {
    double sum = 0;
    for (std::uint32_t seed = 1; seed <= kRuns; ++seed) {
      Normals random(seed);
      std::vector<double> values;
      std::vector<double> variances;
      for (int i = 0; i < 400; ++i) {
        const double own = 0.001 + 0.002 * (i % 4);
        values.push_back(sigma * random.Normal() + own * random.Normal());
        variances.push_back(own * own);
      }
      const double found = ScatterBeyond(values, variances, 400);
      EXPECT_NEAR(found / sigma, 1, 0.4) << seed;
      sum += found * found;
    }
    EXPECT_NEAR(std::sqrt(sum / kRuns) / sigma, 1, 0.07);
  }
}

TEST(ScatterBeyond, IsNothingWhereChanceMayMakeAsMuch) {
  Normals random(5);
  std::vector<double> values;
  for (int i = 0; i < 60; ++i) values.push_back(0.003 * random.Normal());
  EXPECT_EQ(ScatterBeyond(values, std::vector<double>(60, 9e-6), 60), 0);
  EXPECT_EQ(ScatterBeyond(values, std::vector<double>(60, 1e-6), 5), 0);  // too few to tell
  EXPECT_GT(ScatterBeyond(values, std::vector<double>(60, 1e-6), 60), 0.002);
}

TEST(Exceeds, AgreesWithTablesOfTheFDistribution) {
  // Upper 0.0001 points.
  EXPECT_FALSE(Exceeds(0.98 * 6.8, 10, 1, 20));
  EXPECT_TRUE(Exceeds(1.02 * 7.2, 10, 1, 20));
  EXPECT_FALSE(Exceeds(2.5, 15, 1, 100));
  EXPECT_TRUE(Exceeds(4.0, 15, 1, 100));
  EXPECT_FALSE(Exceeds(100, 15, 0, 100));
}

// Poses whose errors are by an unknown factor larger than stated, drawn as it is expected to be,
// and squares that tell of it: first whether there is one, then others how large it is.
TEST(FactorFor, A95PercentRegionHolds95Percent) {
  for (const int freedom : {10, 40}) {
    int inside = 0;
    constexpr int kRuns = 4000;
    Normals random(static_cast<std::uint32_t>(freedom));
    for (int run = 0; run < kRuns; ++run) {
      const bool as_stated = run % 2 == 0;
      const double factor = as_stated ? 1 : std::exp(std::abs(random.Normal()));
      const auto squares = [&](int count) {
        double sum = 0;
        for (int i = 0; i < count; ++i) sum += factor * std::pow(random.Normal(), 2);
        return sum;
      };
      const double stated = FactorFor(squares(freedom) / freedom, freedom,
                                      ShareAsStated(squares(freedom) / freedom, freedom));
      inside += squares(6) < 12.592 * stated ? 1 : 0;
    }
    EXPECT_NEAR(inside / static_cast<double>(kRuns), 0.95, 0.012) << freedom;
  }
}

TEST(ShareAsStated, IsWhatSquaresSay) {
  EXPECT_NEAR(ShareAsStated(1, 0), 0.5, 1e-6);  // of none
  EXPECT_GT(ShareAsStated(0.9, 42), 0.8);
  EXPECT_LT(ShareAsStated(2, 42), 0.02);
  EXPECT_GT(ShareAsStated(1.5, 6), 0.3);
}

TEST(FactorFor, IsNearlyWhatWasMeasuredWhereManySaySo) {
  EXPECT_NEAR(FactorFor(3, 500, 0.2), 3, 0.1);
  EXPECT_LT(FactorFor(0.8, 50, 0.2), 1.1);
  EXPECT_GE(FactorFor(0.1, 50, 0.2), 1);
  EXPECT_LT(FactorFor(20, 3, 0.2), 20);  // few who say that it is much do not prevail
  EXPECT_EQ(FactorFor(2, 10, 1), FactorFor(0.5, 10, 1));  // what is known is not asked
  for (const double freedom : {3.0, 10.0, 100.0}) {
    double last = 1;
    for (double measured = 0.5; measured < 20; measured *= 1.3) {
      const double factor = FactorFor(measured, freedom, 0.2);
      EXPECT_GE(factor, last);
      last = factor;
    }
  }
}

}  // namespace
}  // namespace rgbdt
