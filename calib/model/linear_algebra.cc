#include "calib/model/linear_algebra.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/SVD>

namespace rgbdt {

template <int N, int M>
Eigen::Matrix<double, N, M> SolveSymmetric(const Eigen::Matrix<double, N, N>& a,
                                           const Eigen::Matrix<double, N, M>& b) {
  return a.ldlt().solve(b);
}

template <int N>
Eigen::Matrix<double, N, N> InverseOfSymmetric(const Eigen::Matrix<double, N, N>& a) {
  return a.ldlt().solve(Eigen::Matrix<double, N, N>::Identity(a.rows(), a.rows()));
}

template <int N>
std::optional<Eigen::Matrix<double, N, N>> InverseOfPositive(const Eigen::Matrix<double, N, N>& a) {
  const Eigen::LDLT<Eigen::Matrix<double, N, N>> ldlt(a);
  if (ldlt.info() != Eigen::Success || !(ldlt.vectorD().minCoeff() > 0)) return std::nullopt;
  return ldlt.solve(Eigen::Matrix<double, N, N>::Identity(a.rows(), a.rows()));
}

template <int N>
Eigensystem<N> EigensystemOf(const Eigen::Matrix<double, N, N>& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, N, N>> solver(symmetric);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

Eigen::Matrix3d NearestOrthogonal(const Eigen::Matrix3d& a) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(a, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return svd.matrixU() * svd.matrixV().transpose();
}

#define RGBDT_SOLVE(N, M)                                                                 \
  template Eigen::Matrix<double, N, M> SolveSymmetric(const Eigen::Matrix<double, N, N>&, \
                                                      const Eigen::Matrix<double, N, M>&);
#define RGBDT_INVERSE(N) \
  template Eigen::Matrix<double, N, N> InverseOfSymmetric(const Eigen::Matrix<double, N, N>&);
#define RGBDT_POSITIVE(N)                                                \
  template std::optional<Eigen::Matrix<double, N, N>> InverseOfPositive( \
      const Eigen::Matrix<double, N, N>&);
#define RGBDT_EIGENSYSTEM(N) \
  template Eigensystem<N> EigensystemOf(const Eigen::Matrix<double, N, N>&);

RGBDT_SOLVE(2, 1)
RGBDT_SOLVE(3, 1)
RGBDT_SOLVE(3, 7)
RGBDT_SOLVE(6, 1)
RGBDT_SOLVE(6, 6)
RGBDT_SOLVE(7, 1)
RGBDT_SOLVE(10, 1)
RGBDT_SOLVE(10, 2)
RGBDT_SOLVE(10, Eigen::Dynamic)
RGBDT_SOLVE(11, 1)
RGBDT_SOLVE(16, 1)
RGBDT_SOLVE(Eigen::Dynamic, 1)
RGBDT_SOLVE(Eigen::Dynamic, Eigen::Dynamic)

RGBDT_INVERSE(6)
RGBDT_INVERSE(7)
RGBDT_INVERSE(10)
RGBDT_INVERSE(11)
RGBDT_INVERSE(16)
RGBDT_INVERSE(Eigen::Dynamic)

RGBDT_POSITIVE(2)
RGBDT_POSITIVE(6)

RGBDT_EIGENSYSTEM(2)
RGBDT_EIGENSYSTEM(3)
RGBDT_EIGENSYSTEM(6)
RGBDT_EIGENSYSTEM(7)
RGBDT_EIGENSYSTEM(9)

}  // namespace rgbdt
