#include "calib/solve/internal/lens_check.h"

#include <cmath>

#include "calib/model/linear_algebra.h"

namespace rgbdt {
namespace {

constexpr double kLeastTold = 0.1;  // of the prior's variance that the data must take away

// Columns in which a covariance is the identity; directions without a variance are left out.
Eigen::MatrixXd Whitening(const LensCovariance& covariance) {
  LensNumbers scale = covariance.diagonal().cwiseSqrt();
  for (double& s : scale) s = s > 0 ? 1 / s : 0;
  const auto eigen =
      EigensystemOf(Eigen::MatrixXd(scale.asDiagonal() * covariance * scale.asDiagonal()));
  const Eigen::Index none = (eigen.values.array() <= 1e-9).count();
  const Eigen::Index held = kLensNumbers - none;
  return scale.asDiagonal() * eigen.vectors.rightCols(held) *
         eigen.values.tail(held).cwiseSqrt().cwiseInverse().asDiagonal();
}

}  // namespace

bool LensOff::contradicts() const {
  // Wilson and Hilferty (1931): the cube root of chi-square over its freedom is nearly normal.
  const double spread = 2.0 / (9.0 * std::max(1, freedom));
  const double bound = 1 - spread + 3.72 * std::sqrt(spread);
  return freedom > 0 && chi2 > freedom * bound * bound * bound;
}

LensOff AgainstPrior(const LensNumbers& off, const LensCovariance& prior,
                     const LensCovariance& posterior) {
  LensOff out;
  out.off = off;
  out.covariance = prior + posterior;
  const Eigen::MatrixXd whitening = Whitening(prior);
  if (whitening.cols() == 0) return out;
  const auto eigen = EigensystemOf(Eigen::MatrixXd(whitening.transpose() * posterior * whitening));
  const Eigen::VectorXd along = eigen.vectors.transpose() * (whitening.transpose() * off);
  for (Eigen::Index i = 0; i < along.size(); ++i) {
    const double told = 1 - eigen.values[i];
    if (told < kLeastTold) continue;
    out.chi2 += along[i] * along[i] / told;
    ++out.freedom;
  }
  return out;
}

}  // namespace rgbdt
