#pragma once

#include <Eigen/Core>
#include <optional>

#include "calib/model/rigid3.h"

namespace rgbdt {

/// Decompositions of small matrices, compiled once: where Eigen's templates stand in a source, each
/// costs it seconds. The sizes that are computed most often have an instance of their own.

using Vector7d = Eigen::Matrix<double, 7, 1>;
using Matrix7d = Eigen::Matrix<double, 7, 7>;

/// x of a x = b, `a` symmetric and positive semidefinite (LDL^T with pivoting).
template <int N, int M>
Eigen::Matrix<double, N, M> SolveSymmetric(const Eigen::Matrix<double, N, N>& a,
                                           const Eigen::Matrix<double, N, M>& b);
template <>
Eigen::VectorXd SolveSymmetric(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);
template <>
Eigen::MatrixXd SolveSymmetric(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);
template <>
Eigen::Vector3d SolveSymmetric(const Eigen::Matrix3d& a, const Eigen::Vector3d& b);
template <>
Vector6d SolveSymmetric(const Matrix6d& a, const Vector6d& b);
template <>
Vector7d SolveSymmetric(const Matrix7d& a, const Vector7d& b);

template <int N, int M>
Eigen::Matrix<double, N, M> SolveSymmetric(const Eigen::Matrix<double, N, N>& a,
                                           const Eigen::Matrix<double, N, M>& b) {
  constexpr int kColumns = M == 1 ? 1 : Eigen::Dynamic;
  return SolveSymmetric(Eigen::MatrixXd(a), Eigen::Matrix<double, Eigen::Dynamic, kColumns>(b));
}

/// The inverse of a symmetric, positive semidefinite matrix (LDL^T with pivoting).
template <int N>
Eigen::Matrix<double, N, N> InverseOfSymmetric(const Eigen::Matrix<double, N, N>& a) {
  return SolveSymmetric(Eigen::MatrixXd(a),
                        Eigen::MatrixXd(Eigen::MatrixXd::Identity(a.rows(), a.rows())));
}

/// The same; nothing where `a` is not positive definite.
std::optional<Eigen::MatrixXd> InverseOfPositive(const Eigen::MatrixXd& a);

/// Eigenvalues of a symmetric matrix, rising, and their vectors as columns.
template <int N>
struct Eigensystem {
  Eigen::Matrix<double, N, 1> values;
  Eigen::Matrix<double, N, N> vectors;
};
template <int N>
Eigensystem<N> EigensystemOf(const Eigen::Matrix<double, N, N>& symmetric);
template <>
Eigensystem<3> EigensystemOf(const Eigen::Matrix3d& symmetric);
template <>
Eigensystem<Eigen::Dynamic> EigensystemOf(const Eigen::MatrixXd& symmetric);

template <int N>
Eigensystem<N> EigensystemOf(const Eigen::Matrix<double, N, N>& symmetric) {
  const auto system = EigensystemOf(Eigen::MatrixXd(symmetric));
  return {system.values, system.vectors};
}

/// The rotation (or reflection) nearest to a matrix: U V^T of its singular value decomposition.
Eigen::Matrix3d NearestOrthogonal(const Eigen::Matrix3d& a);

}  // namespace rgbdt
