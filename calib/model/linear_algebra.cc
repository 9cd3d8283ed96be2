#include "calib/model/linear_algebra.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/SVD>

namespace rgbdt {

template <>
Eigen::VectorXd SolveSymmetric(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  return a.ldlt().solve(b);
}

template <>
Eigen::MatrixXd SolveSymmetric(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a.ldlt().solve(b);
}

template <>
Eigen::Vector3d SolveSymmetric(const Eigen::Matrix3d& a, const Eigen::Vector3d& b) {
  return a.ldlt().solve(b);
}

template <>
Vector6d SolveSymmetric(const Matrix6d& a, const Vector6d& b) {
  return a.ldlt().solve(b);
}

template <>
Vector7d SolveSymmetric(const Matrix7d& a, const Vector7d& b) {
  return a.ldlt().solve(b);
}

std::optional<Eigen::MatrixXd> InverseOfPositive(const Eigen::MatrixXd& a) {
  const Eigen::LDLT<Eigen::MatrixXd> ldlt(a);
  if (ldlt.info() != Eigen::Success || !(ldlt.vectorD().minCoeff() > 0)) return std::nullopt;
  return Eigen::MatrixXd(
      ldlt.solve(Eigen::MatrixXd(Eigen::MatrixXd::Identity(a.rows(), a.rows()))));
}

template <>
Eigensystem<3> EigensystemOf(const Eigen::Matrix3d& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(symmetric);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

template <>
Eigensystem<Eigen::Dynamic> EigensystemOf(const Eigen::MatrixXd& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(symmetric);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

Eigen::Matrix3d NearestOrthogonal(const Eigen::Matrix3d& a) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(a, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return svd.matrixU() * svd.matrixV().transpose();
}

}  // namespace rgbdt
