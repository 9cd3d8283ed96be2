#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <type_traits>
#include <vector>

#include "calib/model/rigid3.h"
#include "services/messages/check.h"

namespace rgbdt {

// Inside the codec: the fields of an LCM type W and of its struct S stand side by side in one list,
//   template <typename Copy>
//   void Fields(const Copy& copy, WireOf<Copy, W>& wire, StructOf<Copy, S>& value);
// which copies either way: CopyToWire writes `wire`, CopyFromWire writes `value`.

template <typename Copy, typename W>
using WireOf = typename Copy::template Wire<W>;
template <typename Copy, typename S>
using StructOf = typename Copy::template Struct<S>;

class CopyToWire {
 public:
  template <typename W>
  using Wire = W;
  template <typename S>
  using Struct = const S;

  /// The same type; a bool or an enum as the wire's integer; a part by its own ToWire.
  template <typename W, typename S>
  void operator()(W& wire, const S& value) const {
    if constexpr (std::is_same_v<W, S>) {
      wire = value;
    } else if constexpr (std::is_same_v<S, bool> || std::is_enum_v<S>) {
      wire = static_cast<W>(value);
    } else {
      wire = ToWire(value);
    }
  }
  template <std::size_t N, int M>
  void operator()(double (&wire)[N], const Eigen::Matrix<double, M, 1>& value) const {
    static_assert(N == M);
    Eigen::Map<Eigen::Matrix<double, M, 1>>{wire} = value;
  }
  template <int N, int M>
  void operator()(double (&wire)[N][M], const Eigen::Matrix<double, N, M>& value) const {
    for (int row = 0; row < N; ++row) {
      for (int column = 0; column < M; ++column) wire[row][column] = value(row, column);
    }
  }
  template <typename W, typename S, std::size_t N>
  void operator()(W (&wire)[N], const std::array<S, N>& value) const {
    for (std::size_t i = 0; i < N; ++i) (*this)(wire[i], value[i]);
  }
  /// A row of an array [n][2] or [n][3], of which lcm-gen makes a vector.
  template <typename T, int M>
  void operator()(std::vector<T>& wire, const Eigen::Matrix<T, M, 1>& value) const {
    wire.assign(value.data(), value.data() + M);
  }

  void Pose(double (&quaternion_wxyz)[4], double (&translation_m)[3], const Rigid3& pose) const {
    RotationToWire(pose.rotation, quaternion_wxyz);
    (*this)(translation_m, pose.translation);
  }
  template <typename W, typename S>
  void Optional(std::int8_t& has, W& wire, const std::optional<S>& value) const {
    (*this)(has, value.has_value());
    if (value) (*this)(wire, *value);
  }
  template <typename W, typename S>
  void List(std::string_view name, std::int32_t& count, std::vector<W>& wire,
            const std::vector<S>& value) const {
    count = CountOf(value.size(), name);
    wire.resize(value.size());
    for (std::size_t i = 0; i < value.size(); ++i) (*this)(wire[i], value[i]);
  }
};

class CopyFromWire {
 public:
  template <typename W>
  using Wire = const W;
  template <typename S>
  using Struct = S;

  template <typename W, typename S>
  void operator()(const W& wire, S& value) const {
    if constexpr (std::is_same_v<W, S>) {
      value = wire;
    } else if constexpr (std::is_same_v<S, bool> || std::is_enum_v<S>) {
      value = static_cast<S>(wire);
    } else {
      value = FromWire(wire);
    }
  }
  template <std::size_t N, int M>
  void operator()(const double (&wire)[N], Eigen::Matrix<double, M, 1>& value) const {
    static_assert(N == M);
    value = Eigen::Map<const Eigen::Matrix<double, M, 1>>{wire};
  }
  template <int N, int M>
  void operator()(const double (&wire)[N][M], Eigen::Matrix<double, N, M>& value) const {
    for (int row = 0; row < N; ++row) {
      for (int column = 0; column < M; ++column) value(row, column) = wire[row][column];
    }
  }
  template <typename W, typename S, std::size_t N>
  void operator()(const W (&wire)[N], std::array<S, N>& value) const {
    for (std::size_t i = 0; i < N; ++i) (*this)(wire[i], value[i]);
  }
  template <typename T, int M>
  void operator()(const std::vector<T>& wire, Eigen::Matrix<T, M, 1>& value) const {
    value = Eigen::Map<const Eigen::Matrix<T, M, 1>>{wire.data()};
  }

  void Pose(const double (&quaternion_wxyz)[4], const double (&translation_m)[3],
            Rigid3& pose) const {
    pose.rotation = RotationFromWire(quaternion_wxyz);
    (*this)(translation_m, pose.translation);
  }
  template <typename W, typename S>
  void Optional(std::int8_t has, const W& wire, std::optional<S>& value) const {
    if (has != 0) (*this)(wire, value.emplace());
  }
  template <typename W, typename S>
  void List(std::string_view /*name*/, std::int32_t /*count*/, const std::vector<W>& wire,
            std::vector<S>& value) const {
    value.resize(wire.size());
    for (std::size_t i = 0; i < wire.size(); ++i) (*this)(wire[i], value[i]);
  }
};

/// All of W from an S, where `Fields` lists all of it.
template <typename W, typename S>
W FieldsToWire(const S& value) {
  W wire{};
  Fields(CopyToWire(), wire, value);
  return wire;
}

template <typename S, typename W>
S FieldsFromWire(const W& wire) {
  S value;
  Fields(CopyFromWire(), wire, value);
  return value;
}

}  // namespace rgbdt
