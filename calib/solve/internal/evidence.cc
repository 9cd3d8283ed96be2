#include "calib/solve/internal/evidence.h"

#include <algorithm>
#include <cmath>

#include "calib/model/linear_algebra.h"

namespace rgbdt {
namespace {

constexpr double kAsStated = 0.5;     // of all sessions
constexpr double kUsualLog = 1;       // sigma of the factor's logarithm in the others
constexpr double kInside95 = 12.592;  // chi-square of six degrees of freedom

double SumOver(const std::vector<double>& values, const std::vector<double>& variances,
               double more) {
  double sum = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    sum += values[i] * values[i] / (variances[i] + more);
  }
  return sum;
}

// By which factor variances may be larger than stated, and how likely each is.
struct Factors {
  static constexpr double kMostLog = 6;

  // `freedom` squares, each over its stated variance, have the mean `measured`; before, a session
  // is as stated with this probability.
  Factors(double measured, double freedom, double as_stated) {
    constexpr int kSteps = 300;
    const auto log_likelihood = [&](double log_factor) {
      return -0.5 * freedom * (log_factor + measured * std::exp(-log_factor));
    };
    const double highest = log_likelihood(std::max(0.0, std::log(std::max(measured, 1e-9))));
    const auto prior = [](int step) {
      return std::exp(-0.5 * std::pow(kMostLog * (step + 0.5) / kSteps / kUsualLog, 2));
    };
    double all = 0;
    for (int i = 0; i < kSteps; ++i) all += prior(i);
    values.push_back(1);
    weights.push_back(as_stated * std::exp(log_likelihood(0) - highest));
    for (int i = 0; i < kSteps; ++i) {
      const double log_factor = kMostLog * (i + 0.5) / kSteps;
      values.push_back(std::exp(log_factor));
      weights.push_back((1 - as_stated) * prior(i) / all *
                        std::exp(log_likelihood(log_factor) - highest));
    }
    double sum = 0;
    for (const double weight : weights) sum += weight;
    for (double& weight : weights) weight /= sum;
  }

  // How much of a pose's errors lies beyond its 95% region, taken this much larger.
  double Beyond(double factor) const {
    double sum = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double half = 0.5 * kInside95 * factor / values[i];
      sum += weights[i] * std::exp(-half) * (1 + half + 0.5 * half * half);
    }
    return sum;
  }

  std::vector<double> values;   // the first one, 1: as stated
  std::vector<double> weights;  // together 1
};

}  // namespace

Evidence MostLikelySigma(const Eigen::MatrixXd& information, const Eigen::VectorXd& gradient,
                         double least, double most) {
  constexpr int kSteps = 200;
  const auto system = EigensystemOf(information);
  const Eigen::ArrayXd values = system.values.array().max(0);
  const Eigen::ArrayXd squares = (system.vectors.transpose() * gradient).array().square();
  Evidence best;
  for (int i = 0; i <= kSteps; ++i) {
    const double sigma = least * std::pow(most / least, static_cast<double>(i) / kSteps);
    const double variance = sigma * sigma;
    const double gain =
        (variance * squares / (1 + variance * values) - (1 + variance * values).log()).sum();
    if (gain > best.gain) best = {sigma, gain};
  }
  return best;
}

ViewInformation Marginal(const ViewInformation& all, const std::vector<Eigen::Index>& kept,
                         const std::vector<Eigen::Index>& others) {
  const Eigen::MatrixXd between = all.information(others, kept);
  const Eigen::MatrixXd by_kept =
      SolveSymmetric(Eigen::MatrixXd(all.information(others, others)), between);
  ViewInformation out;
  out.information = all.information(kept, kept) - between.transpose() * by_kept;
  out.gradient = all.gradient(kept) - by_kept.transpose() * Eigen::VectorXd(all.gradient(others));
  return out;
}

double ScatterBeyond(const std::vector<double>& values, const std::vector<double>& variances,
                     double freedom) {
  constexpr double kLeastFreedom = 8;
  if (freedom < kLeastFreedom) return 0;
  // The sum falls with what is added to the variances: between nothing and all that there is.
  if (!(SumOver(values, variances, 0) > freedom + 2.5 * std::sqrt(2 * freedom))) return 0;
  double low = 0;
  double high = 0;
  for (const double value : values) high += value * value / freedom;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (SumOver(values, variances, middle) > freedom ? low : high) = middle;
  }
  return std::sqrt(high);
}

bool Exceeds(double between, double between_freedom, double within, double within_freedom) {
  constexpr double kChanceSigmas = 3.719;
  if (!(within > 0) || between_freedom < 1 || within_freedom < 1) return false;
  const double root = std::cbrt(between / within);
  const double of_between = 2 / (9 * between_freedom);
  const double of_within = 2 / (9 * within_freedom);
  return (1 - of_within) * root - (1 - of_between) >
         kChanceSigmas * std::sqrt(of_within * root * root + of_between);
}

double ShareAsStated(double measured, double freedom) {
  return Factors(measured, freedom, kAsStated).weights.front();
}

double FactorFor(double measured, double freedom, double as_stated) {
  const Factors factors(measured, freedom, as_stated);
  double low = 1;
  double high = std::exp(Factors::kMostLog);
  for (int i = 0; i < 50; ++i) {
    const double middle = std::sqrt(low * high);
    (factors.Beyond(middle) > 0.05 ? low : high) = middle;
  }
  return high;
}

}  // namespace rgbdt
