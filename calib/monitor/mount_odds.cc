#include "calib/monitor/mount_odds.h"

#include <algorithm>
#include <cmath>

#include "calib/model/linear_algebra.h"

namespace rgbdt {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Rows and columns of numbers that are not exact.
std::vector<Index> Free(const MatrixXd& covariance) {
  std::vector<Index> free;
  for (Index k = 0; k < covariance.rows(); ++k) {
    if (covariance(k, k) > 0) free.push_back(k);
  }
  return free;
}

MatrixXd Picked(const MatrixXd& all, const std::vector<Index>& which) {
  const auto n = static_cast<Index>(which.size());
  MatrixXd own(n, n);
  for (Index i = 0; i < n; ++i) {
    for (Index k = 0; k < n; ++k) {
      own(i, k) = all(which[static_cast<std::size_t>(i)], which[static_cast<std::size_t>(k)]);
    }
  }
  return own;
}

// Coordinates in which the prior is the identity.
struct Whitened {
  MatrixXd by;  // x_white = by * x
  explicit Whitened(const MatrixXd& prior) {
    const VectorXd sigma = prior.diagonal().cwiseSqrt();
    const MatrixXd scale = sigma.cwiseInverse().asDiagonal();
    const auto system = EigensystemOf(MatrixXd(scale * prior * scale));
    // Numbers that are made of each other leave directions without variance.
    const VectorXd root = system.values.cwiseMax(1e-9).cwiseSqrt().cwiseInverse();
    by = root.asDiagonal() * system.vectors.transpose() * scale;
  }
};

}  // namespace

double LogOdds(const BeforeAndAfter& found, const MatrixXd& other) {
  const std::vector<Index> free = Free(found.prior);
  const auto n = static_cast<Index>(free.size());
  const Whitened white(Picked(found.prior, free));
  const MatrixXd after = white.by * Picked(found.covariance, free) * white.by.transpose();
  VectorXd mean(n);
  for (Index k = 0; k < n; ++k) mean[k] = found.mean[free[static_cast<std::size_t>(k)]];
  mean = white.by * mean;
  // The likelihood's information and its product with where it is largest, by the directions of
  // what is known afterwards: information afterwards less that beforehand (the identity).
  const auto system = EigensystemOf(after);
  MatrixXd told = MatrixXd::Zero(n, n);
  VectorXd pull = VectorXd::Zero(n);
  for (Index k = 0; k < n; ++k) {
    const double left = std::max(1e-12, system.values[k]);
    if (left >= 1) continue;
    const VectorXd along = system.vectors.col(k);
    told += (1 / left - 1) * along * along.transpose();
    pull += along.dot(mean) / left * along;
  }
  // log of the integral of the likelihood over a prior with covariance T, but for what all T share:
  // -1/2 log |1 + T told| + 1/2 pull' (1 + T told)^-1 T pull, by T = R R'.
  const auto evidence = [&](const MatrixXd& prior) {
    const auto own = EigensystemOf(prior);
    const MatrixXd root = own.vectors * own.values.cwiseMax(0).cwiseSqrt().asDiagonal();
    const MatrixXd inner = MatrixXd::Identity(n, n) + root.transpose() * told * root;
    const VectorXd inside = root.transpose() * pull;
    const double size = EigensystemOf(inner).values.cwiseMax(1e-12).array().log().sum();
    return -0.5 * size + 0.5 * inside.dot(SolveSymmetric(inner, inside));
  };
  const MatrixXd wanted = white.by * Picked(other, free) * white.by.transpose();
  return evidence(wanted) - evidence(MatrixXd::Identity(n, n));
}

double HoldsProbability(double holds, const std::vector<double>& moved, double share) {
  double most = holds;
  for (const double one : moved) most = std::max(most, one);
  double sum = 0;
  for (const double one : moved) sum += std::exp(one - most) / static_cast<double>(moved.size());
  const double stays = (1 - share) * std::exp(holds - most);
  return stays / (stays + share * sum);
}

}  // namespace rgbdt
