#include "calib/files/name_keys.h"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <ctime>
#include <map>
#include <set>

namespace rgbdt {
namespace {

bool IsDigit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

// A name as its runs of digits and what stands around them: "a12b3" is "a0b0" with 12 and 3. A
// digit, as no other stays in the shape.
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
    parts.shape += '0';
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

// The digits behind run `i` that are its fraction: after a point, or as many as one has.
std::string FractionAfter(const std::string& stem, const Parts& parts, std::size_t i) {
  const std::size_t end = parts.begins[i] + parts.digits[i].size();
  if (i + 1 == parts.digits.size() || parts.begins[i + 1] != end + 1) return "";
  const std::string& next = parts.digits[i + 1];
  const char between = stem[end];
  const bool whole = next.size() == 3 || next.size() == 6 || next.size() == 9;
  return between == '.' || ((between == '_' || between == '-') && whole) ? next : "";
}

// The run of digits `i` as a time, with the fraction that may follow it.
std::optional<Utime> TimeAt(const std::string& stem, const Parts& parts, std::size_t i) {
  const std::string& run = parts.digits[i];
  const std::size_t length = run.size();
  if (length == 13 || length == 16 || length == 19) return Microseconds(run);
  if (length != kSecondsDigits) return std::nullopt;
  return Microseconds(run + FractionAfter(stem, parts, i));
}

// Year, month, day, hour, minute, second as runs of digits from `i` on, together or apart, and the
// fraction that may follow them.
std::optional<Utime> DateAt(const std::string& stem, const Parts& parts, std::size_t i) {
  constexpr std::size_t kDigits = 14;
  std::string date, fraction;
  std::size_t run = i;
  for (; run < parts.digits.size() && date.size() < kDigits; ++run) {
    const std::string& digits = parts.digits[run];
    const bool first = run == i;
    const bool fits = first ? digits.size() == 4 || digits.size() == 8 || digits.size() >= kDigits
                            : digits.size() == 2 || date.size() + digits.size() >= kDigits;
    // One letter or sign between them: 2023-05-14T10_15_23.
    const bool joined =
        first || parts.begins[run] == parts.begins[run - 1] + parts.digits[run - 1].size() + 1;
    if (!fits || !joined) return std::nullopt;
    date += digits;
  }
  if (date.size() < kDigits) return std::nullopt;
  fraction = date.substr(kDigits);
  date.resize(kDigits);
  if (fraction.empty()) fraction = FractionAfter(stem, parts, run - 1);
  if (fraction.size() > 9) return std::nullopt;
  fraction.resize(6, '0');
  const auto number = [&](std::size_t at, std::size_t count) {
    return std::stoi(date.substr(at, count));
  };
  std::tm when{};
  when.tm_year = number(0, 4) - 1900;
  when.tm_mon = number(4, 2) - 1;
  when.tm_mday = number(6, 2);
  when.tm_hour = number(8, 2);
  when.tm_min = number(10, 2);
  when.tm_sec = number(12, 2);
  const bool good = when.tm_year > 100 && when.tm_year < 200 && when.tm_mon >= 0 &&
                    when.tm_mon < 12 && when.tm_mday >= 1 && when.tm_mday <= 31 &&
                    when.tm_hour < 24 && when.tm_min < 60 && when.tm_sec < 61;
  if (!good) return std::nullopt;
  return static_cast<Utime>(timegm(&when)) * kMicrosecondsPerSecond + std::stoll(fraction);
}

}  // namespace

std::string StemOf(const std::filesystem::path& file) {
  const std::filesystem::path stem = file.stem();
  return (stem.extension() == ".pcd" ? stem.stem() : stem).string();
}

std::optional<Utime> TimeInName(const std::string& stem) {
  const Parts parts = Divide(stem);
  for (std::size_t i = 0; i < parts.digits.size(); ++i) {
    if (const std::optional<Utime> time = TimeAt(stem, parts, i)) return time;
  }
  // A date may be the session's, and the file's own time stand behind it.
  for (std::size_t i = 0; i < parts.digits.size(); ++i) {
    if (const std::optional<Utime> date = DateAt(stem, parts, i)) return date;
  }
  return std::nullopt;
}

NameNumbers NumbersInNames(const std::vector<std::string>& stems) {
  std::vector<Parts> names;
  std::map<std::string, int> shapes;
  for (const std::string& stem : stems) {
    names.push_back(Divide(stem));
    if (!names.back().digits.empty()) ++shapes[names.back().shape];
  }
  NameNumbers found;
  found.numbers.resize(stems.size());
  if (shapes.empty()) return found;
  const auto usual =
      std::max_element(shapes.begin(), shapes.end(),
                       [](const auto& a, const auto& b) { return a.second < b.second; });
  const std::size_t runs =
      static_cast<std::size_t>(std::count(usual->first.begin(), usual->first.end(), '0'));
  // The first run of digits that is another one in each name.
  bool chosen = false;
  int changing = 0;
  for (std::size_t run = 0; run < runs; ++run) {
    std::vector<std::string> numbers(stems.size());
    std::set<std::string> seen;
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (names[i].shape != usual->first) continue;
      numbers[i] = WithoutZeros(names[i].digits[run]);
      seen.insert(numbers[i]);
    }
    if (seen.size() > 1) ++changing;
    if (chosen || seen.size() != static_cast<std::size_t>(usual->second)) continue;
    found.numbers = std::move(numbers);
    chosen = true;
  }
  found.sole = changing <= 1;
  return found;
}

}  // namespace rgbdt
