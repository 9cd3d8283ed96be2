#pragma once

// Inside the codec: points, matrices and poses as lcm-gen stores them.

#include <Eigen/Core>
#include <string_view>
#include <vector>

#include "calib/model/rigid3.h"
#include "services/messages/check.h"

namespace rgbdt {

// lcm-gen makes a vector of vectors of an array [n][2] or [n][3].
template <typename Row>
std::vector<std::vector<double>> RowsToWire(const std::vector<Row>& rows) {
  std::vector<std::vector<double>> wire(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    wire[i].assign(rows[i].data(), rows[i].data() + rows[i].size());
  }
  return wire;
}

template <typename Row>
std::vector<Row> RowsFromWire(const std::vector<std::vector<double>>& wire) {
  std::vector<Row> rows(wire.size());
  for (std::size_t i = 0; i < wire.size(); ++i) rows[i] = Row(wire[i].data());
  return rows;
}

inline void CheckRows(std::string_view field, const std::vector<std::vector<double>>& rows) {
  for (const std::vector<double>& row : rows) CheckFinite(field, row.data(), row.size());
}

inline void VectorToWire(const Eigen::Vector3d& vector, double wire[3]) {
  for (int i = 0; i < 3; ++i) wire[i] = vector[i];
}

template <int N>
void MatrixToWire(const Eigen::Matrix<double, N, N>& matrix, double (*wire)[N]) {
  for (int row = 0; row < N; ++row) {
    for (int column = 0; column < N; ++column) wire[row][column] = matrix(row, column);
  }
}

template <int N>
Eigen::Matrix<double, N, N> MatrixFromWire(const double (*wire)[N]) {
  Eigen::Matrix<double, N, N> matrix;
  for (int row = 0; row < N; ++row) {
    for (int column = 0; column < N; ++column) matrix(row, column) = wire[row][column];
  }
  return matrix;
}

inline void RigidToWire(const Rigid3& rigid, double quaternion_wxyz[4], double translation_m[3]) {
  RotationToWire(rigid.rotation, quaternion_wxyz);
  VectorToWire(rigid.translation, translation_m);
}

inline Rigid3 RigidFromWire(const double quaternion_wxyz[4], const double translation_m[3]) {
  return {RotationFromWire(quaternion_wxyz), Eigen::Vector3d(translation_m)};
}

}  // namespace rgbdt
