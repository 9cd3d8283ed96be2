#pragma once

#include <cstddef>
#include <vector>

namespace rgbdt {

/// Elements [first, end); of an empty vector (nothing known of its cloud's points) nothing.
template <typename T>
std::vector<T> Slice(const std::vector<T>& all, std::size_t first, std::size_t end) {
  if (all.empty()) return {};
  return {all.begin() + static_cast<std::ptrdiff_t>(first),
          all.begin() + static_cast<std::ptrdiff_t>(end)};
}

}  // namespace rgbdt
