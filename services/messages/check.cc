#include "services/messages/check.h"

#include <cmath>
#include <cstdio>

#include "calib/model/errors.h"
#include "calib/model/printable.h"
#include "calib/model/said_again.h"
#include "calib/model/text.h"

namespace rgbdt {
namespace {

std::string Quoted(const std::string& text) { return "\"" + Printable(text, 40) + "\""; }

void CheckUtf8(std::string_view field, const std::string& text, bool newlines) {
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = Utf8Length(text, i);
    const char c = text[i];
    const bool kept = newlines && (c == '\n' || c == '\t' || c == '\r');
    if (length == 0 || (!kept && IsControl(text, i, length))) {
      Fail(field, Quoted(text),
           "UTF-8 without control characters (byte " + std::to_string(i) + ")");
    }
    i += length;
  }
}

}  // namespace

void Fail(std::string_view field, const std::string& value, const std::string& expected) {
  throw InputError(std::string(field) + " is " + value + "; expected " + expected);
}

void Fail(std::string_view field, double value, const std::string& expected) {
  Fail(field, Format("%.9g", value), expected);
}

std::string Printable(std::string_view text, std::size_t max_bytes) {
  std::string shown(text.substr(0, max_bytes));
  for (char& c : shown) {
    if (c < 0x20 || c > 0x7e) c = '?';
  }
  return text.size() > max_bytes ? shown + "..." : shown;
}

std::string At(std::string_view field, std::size_t index) {
  return std::string(field) + "[" + std::to_string(index) + "]";
}

std::int32_t CountOf(std::size_t size, std::string_view field) {
  if (size > kMaxMessageBytes) {
    Fail(field, std::to_string(size), "so few that the message stays below 3 MB");
  }
  return static_cast<std::int32_t>(size);
}

void CheckLength(std::string_view field, std::size_t size, std::size_t expected,
                 bool may_be_empty) {
  if (size == expected || (may_be_empty && size == 0)) return;
  Fail("length of " + std::string(field), std::to_string(size), std::to_string(expected));
}

void CheckUtime(std::string_view field, Utime utime) { CheckRange(field, utime, 1, kMaxInteger); }

void CheckUtimeOrZero(std::string_view field, Utime utime) {
  CheckRange(field, utime, 0, kMaxInteger);
}

void CheckSeq(std::int64_t seq) { CheckRange("seq", seq, kSaidAgain, kMaxInteger); }

void CheckRange(std::string_view field, std::int64_t value, std::int64_t low, std::int64_t high) {
  if (value >= low && value <= high) return;
  Fail(field, std::to_string(value), std::to_string(low) + " to " + std::to_string(high));
}

void CheckFinite(std::string_view field, double value) {
  if (!std::isfinite(value)) Fail(field, value, "a finite number");
}

void CheckNotNegative(std::string_view field, double value) {
  if (!std::isfinite(value) || value < 0) Fail(field, value, "a finite number from 0 on");
}

void CheckShare(std::string_view field, double value) {
  if (!(value >= 0 && value <= 1)) Fail(field, value, "0 to 1");
}

void CheckFinite(std::string_view field, const double* values, std::size_t size) {
  for (std::size_t i = 0; i < size; ++i) {
    if (!std::isfinite(values[i])) Fail(At(field, i), values[i], "a finite number");
  }
}

void CheckUnitVector(std::string_view field, const Eigen::Vector3d& v) {
  if (!(std::abs(v.norm() - 1) <= 1e-3))
    Fail("length of " + std::string(field), v.norm(), "1: a unit vector");
}

void CheckCovariance(std::string_view field, const double* rows, int size) {
  CheckFinite(field, rows, static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
  const auto at = [&](int row, int column) { return rows[row * size + column]; };
  for (int row = 0; row < size; ++row) {
    if (at(row, row) < 0) Fail("diagonal of " + std::string(field), at(row, row), "0 or more");
    for (int column = 0; column < row; ++column) {
      const double scale = std::sqrt(at(row, row)) * std::sqrt(at(column, column));
      const double difference = std::abs(at(row, column) - at(column, row));
      if (!(difference <= 1e-6 * scale)) {
        Fail("asymmetry of " + std::string(field), difference, "a symmetric matrix");
      }
    }
  }
}

void CheckRows(std::string_view field, const std::vector<std::vector<double>>& rows) {
  for (const std::vector<double>& row : rows) CheckFinite(field, row.data(), row.size());
}

void CheckCameraName(std::string_view field, const std::string& name) {
  bool good = !name.empty() && name.size() <= 32;
  for (const char c : name) good &= (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
  if (!good) Fail(field, Quoted(name), "a camera's name: 1 to 32 of a-z, 0-9 and _");
}

void CheckName(std::string_view field, const std::string& name, bool may_be_empty) {
  if (name.empty() && may_be_empty) return;
  const bool bad_path = name.empty() || name.size() > kMaxNameBytes || name.front() == '.' ||
                        name.find_first_of("/\\") != std::string::npos;
  if (bad_path) {
    Fail(field, Quoted(name), "1 to 255 characters, no slashes and no dot to begin with");
  }
  CheckUtf8(field, name, false);
}

void CheckText(std::string_view field, const std::string& text, std::size_t max_bytes) {
  if (text.size() > max_bytes) {
    Fail("length of " + std::string(field), std::to_string(text.size()),
         std::to_string(max_bytes) + " at most");
  }
  CheckUtf8(field, text, true);
}

void CheckRotation(std::string_view field, const double wxyz[4]) {
  CheckFinite(field, wxyz, 4);
  const double norm = std::hypot(std::hypot(wxyz[0], wxyz[1]), std::hypot(wxyz[2], wxyz[3]));
  if (!(std::abs(norm - 1) <= 1e-3))
    Fail("norm of " + std::string(field), norm, "1: a unit quaternion");
}

Eigen::Quaterniond RotationFromWire(const double wxyz[4]) {
  const Eigen::Quaterniond rotation(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
  return std::abs(rotation.squaredNorm() - 1) < 1e-14 ? rotation : rotation.normalized();
}

void RotationToWire(const Eigen::Quaterniond& rotation, double wxyz[4]) {
  wxyz[0] = rotation.w();
  wxyz[1] = rotation.x();
  wxyz[2] = rotation.y();
  wxyz[3] = rotation.z();
}

}  // namespace rgbdt
