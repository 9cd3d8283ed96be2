#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "calib/model/time.h"
#include "services/messages/limits.h"

namespace rgbdt {

// Rules for a message's fields. Each throws InputError with the field, its value and what was
// expected. Sender and receiver apply the same rules: Encode refuses what Decode would drop.

[[noreturn]] void Fail(std::string_view field, const std::string& value,
                       const std::string& expected);
[[noreturn]] void Fail(std::string_view field, double value, const std::string& expected);

/// Text of unknown origin, made fit for an error message: cut, anything but printable ASCII as '?'.
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
void CheckShare(std::string_view field, double value);        ///< 0 to 1
void CheckFinite(std::string_view field, const double* values, std::size_t size);

/// Every value is good(value); `good` decides about NaN, too. One pass without branches, as the
/// clouds on the live path are long; the bad value is searched for only if there is one.
template <typename T, typename Good>
void CheckEach(std::string_view field, const std::vector<T>& values, const Good& good,
               const char* expected) {
  unsigned bad = 0;
  for (const T value : values) bad |= static_cast<unsigned>(!good(value));
  if (bad == 0) return;
  const auto first = std::find_if_not(values.begin(), values.end(), good);
  Fail(At(field, static_cast<std::size_t>(first - values.begin())), static_cast<double>(*first),
       expected);
}

void CheckUnitVector(std::string_view field, const Eigen::Vector3d& v);

/// `size` rows of `size` numbers: finite, no variance below zero, symmetric to 1e-6 of the two
/// sigmas' product. Holds for a scatter matrix, too: a covariance times a count.
void CheckCovariance(std::string_view field, const double* rows, int size);

/// Every number of an array [n][2] or [n][3] is finite.
void CheckRows(std::string_view field, const std::vector<std::vector<double>>& rows);

/// As in the rig file: 1 to 32 of a-z, 0-9 and _.
void CheckCameraName(std::string_view field, const std::string& name);
/// Fit for a file's name: UTF-8 without control characters, slashes and a leading dot.
void CheckName(std::string_view field, const std::string& name, bool may_be_empty = false);
/// For a person, or the content of a file: UTF-8 without control characters other than tab and
/// newlines.
void CheckText(std::string_view field, const std::string& text,
               std::size_t max_bytes = kMaxTextBytes);

/// Finite, norm within 1e-3 of 1.
void CheckRotation(std::string_view field, const double wxyz[4]);
/// Normalised, unless it is normalised to rounding already: so a message that is sent on does not
/// change.
Eigen::Quaterniond RotationFromWire(const double wxyz[4]);
void RotationToWire(const Eigen::Quaterniond& rotation, double wxyz[4]);

}  // namespace rgbdt
