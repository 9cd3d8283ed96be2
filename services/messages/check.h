#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "calib/model/time.h"

namespace rgbdt {

// What a message's fields must keep, each throwing InputError with field, value and expectation.
// Sender and receiver hold a message to the same: Encode refuses what Decode would drop.

/// No message is larger: LCM loses large messages first.
inline constexpr std::size_t kMaxMessageBytes = 3 * 1024 * 1024;
/// Times and numbers below 2^53 survive a double, so every language's tools can hold them.
inline constexpr std::int64_t kMaxInteger = std::int64_t{1} << 53;
/// [m]; nothing that a LIDAR sees is farther, and its square still is a finite float.
inline constexpr float kMaxMetres = 1e6F;
inline constexpr std::size_t kMaxNameBytes = 255;
inline constexpr std::size_t kMaxTextBytes = 64 * 1024;
inline constexpr int kMaxImageSide = 20000;  ///< [px]

[[noreturn]] void Fail(std::string_view field, const std::string& value,
                       const std::string& expected);
[[noreturn]] void Fail(std::string_view field, double value, const std::string& expected);

/// What came from elsewhere, for a message to a person: cut, anything but printable ASCII as '?'.
std::string Printable(std::string_view text, std::size_t max_bytes);

/// "x_m[17]"
std::string At(std::string_view field, std::size_t index);

/// A vector's length as the wire's int32; no vector of that many elements fits into a message.
std::int32_t CountOf(std::size_t size, std::string_view field);

/// `size` is `expected`, or 0 where `may_be_empty`.
void CheckLength(std::string_view field, std::size_t size, std::size_t expected,
                 bool may_be_empty = true);

void CheckUtime(std::string_view field, Utime utime);        ///< 1 to 2^53
void CheckUtimeOrZero(std::string_view field, Utime utime);  ///< 0 to 2^53
void CheckSeq(std::int64_t seq);                             ///< 0 to 2^53
void CheckRange(std::string_view field, std::int64_t value, std::int64_t low, std::int64_t high);
void CheckFinite(std::string_view field, double value);
void CheckNotNegative(std::string_view field, double value);  ///< finite and >= 0
void CheckFinite(std::string_view field, const double* values, std::size_t size);

/// Every value is good(value), which is not so for a NaN unless it says so. One pass without
/// branches, as the clouds on the live path are long; the culprit is looked for only if there is.
template <typename T, typename Good>
void CheckEach(std::string_view field, const std::vector<T>& values, const Good& good,
               const char* expected) {
  unsigned bad = 0;
  for (const T value : values) bad |= static_cast<unsigned>(!good(value));
  if (bad == 0) return;
  const auto culprit = std::find_if_not(values.begin(), values.end(), good);
  Fail(At(field, static_cast<std::size_t>(culprit - values.begin())), static_cast<double>(*culprit),
       expected);
}

void CheckUnitVector(std::string_view field, const Eigen::Vector3d& v);

/// `size` rows of `size` numbers: finite, no variance below zero, symmetric to 1e-6 of the two
/// sigmas' product. So for a scatter, too, a covariance before its division by a count.
void CheckCovariance(std::string_view field, const double* rows, int size);

/// As the rig file has it: 1 to 32 of a-z, 0-9 and _.
void CheckCameraName(std::string_view field, const std::string& name);
/// May become a file's name: UTF-8 without control characters, slashes and a leading dot.
void CheckName(std::string_view field, const std::string& name, bool may_be_empty = false);
/// For a person, or a file: UTF-8 without control characters other than tab and newlines.
void CheckText(std::string_view field, const std::string& text,
               std::size_t max_bytes = kMaxTextBytes);

/// Finite, norm within 1e-3 of 1.
void CheckRotation(std::string_view field, const double wxyz[4]);
/// Normalised; untouched where it is to rounding, so that what has crossed the bus once does not
/// change when it crosses again.
Eigen::Quaterniond RotationFromWire(const double wxyz[4]);
void RotationToWire(const Eigen::Quaterniond& rotation, double wxyz[4]);

}  // namespace rgbdt
