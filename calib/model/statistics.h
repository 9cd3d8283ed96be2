#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace rgbdt {

/// A figure and its uncertainty (1 sigma).
struct Estimate {
  double value = 0;
  double sigma = 0;
};

/// What stands at place k, from 0, when the values are sorted. No value may be NaN.
template <typename T>
T Nth(std::vector<T> values, std::size_t k) {
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(k);
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

/// The middle value; of an even count the upper one of the two in the middle, so that a median is
/// always a value that is there. `of_none`: of no values. No value may be NaN.
template <typename T>
T Median(std::vector<T> values, T of_none = 0) {
  if (values.empty()) return of_none;
  const std::size_t middle = values.size() / 2;
  return Nth(std::move(values), middle);
}

}  // namespace rgbdt
