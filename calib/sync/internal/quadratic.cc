#include "calib/sync/internal/quadratic.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace rgbdt::sync {

Quadratic QuadraticSum::Root() const {
  // Radians, metres and rows do not compare: each unknown in units of what is known of it alone.
  Quadratic::Vector scale;
  for (int i = 0; i < Quadratic::kSize; ++i) {
    scale[i] = information_(i, i) > 0 ? std::sqrt(information_(i, i)) : 1;
  }
  const Quadratic::Vector inverse = scale.cwiseInverse();
  const Quadratic::Matrix unit = inverse.asDiagonal() * information_ * inverse.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Quadratic::Matrix> parts(unit);
  Quadratic quadratic;
  quadratic.rows = rows_;
  for (int i = 0; i < Quadratic::kSize; ++i) {
    const double value = parts.eigenvalues()[i];
    if (value < 1e-9) continue;  // not told
    const Quadratic::Vector direction = parts.eigenvectors().col(i);
    quadratic.root.row(i) = std::sqrt(value) * direction.cwiseProduct(scale).transpose();
    quadratic.rest[i] = direction.dot(inverse.cwiseProduct(gradient_)) / std::sqrt(value);
    ++quadratic.rank;
  }
  quadratic.misfit = std::max(0.0, square_ - quadratic.rest.squaredNorm());
  return quadratic;
}

}  // namespace rgbdt::sync
