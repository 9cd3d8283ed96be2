#pragma once

#include <Eigen/Core>
#include <optional>

namespace rgbdt {

/// Decompositions of small matrices, compiled once: where Eigen's templates stand in a source, each
/// costs it seconds. The sizes there are stand at the end of linear_algebra.cc.

/// x of a x = b, `a` symmetric and positive semidefinite (LDL^T with pivoting). N x N, N x M.
template <int N, int M>
Eigen::Matrix<double, N, M> SolveSymmetric(const Eigen::Matrix<double, N, N>& a,
                                           const Eigen::Matrix<double, N, M>& b);

/// The inverse of a symmetric, positive semidefinite matrix (LDL^T with pivoting).
template <int N>
Eigen::Matrix<double, N, N> InverseOfSymmetric(const Eigen::Matrix<double, N, N>& a);

/// The same; nothing where `a` is not positive definite.
template <int N>
std::optional<Eigen::Matrix<double, N, N>> InverseOfPositive(const Eigen::Matrix<double, N, N>& a);

/// Eigenvalues of a symmetric matrix, rising, and their vectors as columns.
template <int N>
struct Eigensystem {
  Eigen::Matrix<double, N, 1> values;
  Eigen::Matrix<double, N, N> vectors;
};
template <int N>
Eigensystem<N> EigensystemOf(const Eigen::Matrix<double, N, N>& symmetric);

/// The rotation (or reflection) nearest to a matrix: U V^T of its singular value decomposition.
Eigen::Matrix3d NearestOrthogonal(const Eigen::Matrix3d& a);

}  // namespace rgbdt
