#include "calib/files/import/internal/name_keys.h"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <map>
#include <set>

namespace rgbdt {
namespace {

bool IsDigit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

// A name as its runs of digits and what stands around them: "a12b3" is "a#b#" with 12 and 3.
struct Parts {
  std::string shape;
  std::vector<std::string> digits;
  std::vector<std::size_t> begins;  // of the runs, in the name
};

Parts Divide(const std::string& stem) {
  Parts parts;
  for (std::size_t i = 0; i < stem.size();) {
    if (!IsDigit(stem[i])) {
      parts.shape += stem[i++];
      continue;
    }
    const std::size_t begin = i;
    while (i < stem.size() && IsDigit(stem[i])) ++i;
    parts.shape += '#';
    parts.digits.push_back(stem.substr(begin, i - begin));
    parts.begins.push_back(begin);
  }
  return parts;
}

std::string WithoutZeros(const std::string& digits) {
  const std::size_t first = digits.find_first_not_of('0');
  return first == std::string::npos ? "0" : digits.substr(first);
}

constexpr std::size_t kSecondsDigits = 10;  // of times from 2001 to 2286
constexpr std::int64_t kMostSeconds = 4'102'444'800;

// The first 16 digits as microseconds; missing ones are zeros.
std::optional<Utime> Microseconds(std::string digits) {
  digits.resize(kSecondsDigits + 6, '0');
  const Utime utime = std::stoll(digits);
  const std::int64_t seconds = utime / kMicrosecondsPerSecond;
  if (seconds < 1'000'000'000 || seconds >= kMostSeconds) return std::nullopt;
  return utime;
}

// The run of digits `i` as a time, with the fraction that may follow it.
std::optional<Utime> TimeAt(const std::string& stem, const Parts& parts, std::size_t i) {
  const std::string& run = parts.digits[i];
  const std::size_t length = run.size();
  if (length == 13 || length == 16 || length == 19) return Microseconds(run);
  if (length != kSecondsDigits) return std::nullopt;
  const std::size_t end = parts.begins[i] + length;
  const bool joined = i + 1 < parts.digits.size() && parts.begins[i + 1] == end + 1;
  if (!joined) return Microseconds(run);
  const std::string& next = parts.digits[i + 1];
  const char between = stem[end];
  const bool whole = next.size() == 3 || next.size() == 6 || next.size() == 9;
  const bool fraction = between == '.' || ((between == '_' || between == '-') && whole);
  return Microseconds(fraction ? run + next : run);
}

}  // namespace

std::optional<Utime> TimeInName(const std::string& stem) {
  const Parts parts = Divide(stem);
  for (std::size_t i = 0; i < parts.digits.size(); ++i) {
    if (const std::optional<Utime> time = TimeAt(stem, parts, i)) return time;
  }
  return std::nullopt;
}

std::vector<std::string> NumbersInNames(const std::vector<std::string>& stems) {
  std::vector<Parts> names;
  std::map<std::string, int> shapes;
  for (const std::string& stem : stems) {
    names.push_back(Divide(stem));
    if (!names.back().digits.empty()) ++shapes[names.back().shape];
  }
  std::vector<std::string> numbers(stems.size());
  if (shapes.empty()) return numbers;
  const auto usual =
      std::max_element(shapes.begin(), shapes.end(),
                       [](const auto& a, const auto& b) { return a.second < b.second; });
  const std::size_t runs =
      static_cast<std::size_t>(std::count(usual->first.begin(), usual->first.end(), '#'));
  // The first run of digits that is another one in each name.
  for (std::size_t run = 0; run < runs; ++run) {
    std::set<std::string> seen;
    for (std::size_t i = 0; i < names.size(); ++i) {
      const bool counts = names[i].shape == usual->first && run < names[i].digits.size();
      numbers[i] = counts ? WithoutZeros(names[i].digits[run]) : "";
      if (counts) seen.insert(numbers[i]);
    }
    if (seen.size() == static_cast<std::size_t>(usual->second)) return numbers;
  }
  return std::vector<std::string>(stems.size());
}

}  // namespace rgbdt
