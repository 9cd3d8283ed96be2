#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <Eigen/Core>
#include <array>
#include <vector>

namespace rgbdt::python {

namespace py = pybind11;

/// `data` as a numpy array that shares its memory: read-only, and `owner`, whose memory it is,
/// lives as long as the array does.
template <typename Scalar>
py::array Shared(const Scalar* data, std::vector<py::ssize_t> shape, py::handle owner,
                 std::vector<py::ssize_t> strides = {}) {
  py::array array(py::dtype::of<Scalar>(), std::move(shape), std::move(strides), data, owner);
  array.attr("flags").attr("writeable") = false;
  return array;
}

inline py::ssize_t Length(std::size_t size) { return static_cast<py::ssize_t>(size); }

/// N numbers; None where there are none, as a sensor that does not tell them leaves them.
template <typename Scalar>
py::object SharedOrNone(const std::vector<Scalar>& values, py::handle owner) {
  if (values.empty()) return py::none();
  return Shared(values.data(), {Length(values.size())}, owner);
}

/// N x 3.
inline py::array Shared(const std::vector<Eigen::Vector3f>& vectors, py::handle owner) {
  static_assert(sizeof(Eigen::Vector3f) == 3 * sizeof(float));
  return Shared(vectors.empty() ? nullptr : vectors[0].data(), {Length(vectors.size()), 3}, owner);
}

inline py::object SharedOrNone(const std::vector<Eigen::Vector3f>& vectors, py::handle owner) {
  if (vectors.empty()) return py::none();
  return Shared(vectors, owner);
}

/// A matrix or vector as a numpy array of its own.
template <typename Matrix>
py::array_t<double> Copied(const Matrix& matrix) {
  py::array_t<double> array({Length(static_cast<std::size_t>(matrix.rows())),
                             Length(static_cast<std::size_t>(matrix.cols()))});
  for (Eigen::Index r = 0; r < matrix.rows(); ++r) {
    for (Eigen::Index c = 0; c < matrix.cols(); ++c) array.mutable_at(r, c) = matrix(r, c);
  }
  return array;
}

}  // namespace rgbdt::python
