#pragma once

#include <stdexcept>
#include <string>

namespace rgbdt {

/// Bad input. The message is for a person: what is wrong (with the values), where, and what to do.
class InputError : public std::runtime_error {
 public:
  explicit InputError(const std::string& what) : std::runtime_error(what) {}
};

}  // namespace rgbdt
