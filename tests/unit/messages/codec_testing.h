#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "calib/model/errors.h"
#include "services/messages/codec.h"

namespace rgbdt::testing {

inline std::string ErrorOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const InputError& e) {
    return e.what();
  }
  return "no error";
}

template <typename T>
T ThroughTheWire(const T& message) {
  const Bytes bytes = Encode(message);
  return std::get<T>(Decode(ChannelOf(message), bytes.data(), bytes.size()));
}

/// An LCM struct as it lies on the wire, whether its fields are good or not.
template <typename Wire>
Bytes BytesOf(const Wire& wire) {
  Bytes bytes(static_cast<std::size_t>(wire.getEncodedSize()));
  wire.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

/// Decode's error about a valid message, encoded, whose LCM fields were changed.
template <typename Wire, typename Change>
std::string ErrorAfter(const std::string& channel, const Bytes& good, const Change& change) {
  Wire wire;
  EXPECT_GT(wire.decode(good.data(), 0, static_cast<int>(good.size())), 0);
  change(wire);
  const Bytes bytes = BytesOf(wire);
  return ErrorOf([&] { Decode(channel, bytes.data(), bytes.size()); });
}

template <typename Wire, typename Change>
std::string ErrorAfter(const Message& message, const Change& change) {
  return ErrorAfter<Wire>(ChannelOf(message), Encode(message), change);
}

inline void ExpectSameRigid(const Rigid3& a, const Rigid3& b) {
  EXPECT_LT((a.rotation.coeffs() - b.rotation.coeffs()).norm(), 1e-15);
  EXPECT_EQ(a.translation, b.translation);
}

}  // namespace rgbdt::testing
