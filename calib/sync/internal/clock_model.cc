#include "calib/sync/internal/clock_model.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace rgbdt::sync {
namespace {

constexpr double kBeyondChance = 20;  // chi-square's fall by one number more; by three: 10 more

struct Fitted {
  Eigen::VectorXd numbers;
  Eigen::MatrixXd covariance;
  double chi2 = 0;
};

Fitted Fit(const OffsetsOverTime& offsets, const Eigen::LDLT<Eigen::MatrixXd>& inverse,
           const Eigen::MatrixXd& model) {
  Fitted fitted;
  const Eigen::MatrixXd weighed = inverse.solve(model);
  fitted.covariance = (model.transpose() * weighed).inverse();
  fitted.numbers = fitted.covariance * (weighed.transpose() * offsets.values);
  const Eigen::VectorXd off = offsets.values - model * fitted.numbers;
  fitted.chi2 = off.dot(inverse.solve(off));
  return fitted;
}

}  // namespace

ClockModel FitClock(const OffsetsOverTime& offsets) {
  ClockModel clock;
  const Eigen::Index count = offsets.values.size();
  if (count == 0) return clock;
  const Eigen::LDLT<Eigen::MatrixXd> inverse(offsets.covariance);
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(count);
  const Fitted constant = Fit(offsets, inverse, ones);
  clock.mean_s = constant.numbers[0];
  if (count < 4) return clock;

  Eigen::MatrixXd line(count, 2);
  line << ones, offsets.seconds;
  const Fitted straight = Fit(offsets, inverse, line);
  // A step, the place nearest to it free, as it may have been half there.
  std::optional<Fitted> step;
  Eigen::Index at = 0;
  for (Eigen::Index k = 1; k + 1 < count; ++k) {
    Eigen::MatrixXd model = Eigen::MatrixXd::Zero(count, 3);
    model.col(0).setOnes();
    model.col(1).tail(count - k - 1).setOnes();
    model(k, 2) = 1;
    const Fitted tried = Fit(offsets, inverse, model);
    if (step && tried.chi2 >= step->chi2) continue;
    step = tried;
    at = k;
  }
  const double by_line = constant.chi2 - straight.chi2;
  const double by_step = constant.chi2 - step->chi2;
  const double freedom = static_cast<double>(count - 1);
  const double of_chance = freedom + 5 * std::sqrt(2 * freedom);
  // It is what the model says only where that leaves little.
  const auto explains = [&](double by) {
    return constant.chi2 - by < std::max(of_chance, 0.5 * constant.chi2);
  };
  if (by_step > kBeyondChance + 10 && by_step > by_line + 10 && explains(by_step)) {
    clock.jump = {offsets.seconds[at], {step->numbers[1], std::sqrt(step->covariance(1, 1))}};
  } else if (by_line > kBeyondChance && explains(by_line)) {
    clock.drift = {straight.numbers[1], std::sqrt(straight.covariance(1, 1))};
  } else {
    clock.wanders = constant.chi2 > of_chance;
  }
  if (clock.jump || clock.drift || clock.wanders) {
    clock.mean_s = offsets.values.mean();
    const double scatter = (offsets.values.array() - clock.mean_s).square().mean();
    clock.spread_s = std::sqrt(std::max(0.0, scatter - offsets.covariance.diagonal().mean()));
  }
  return clock;
}

}  // namespace rgbdt::sync
