#pragma once

#include <filesystem>
#include <string>

namespace rgbdt {

/// What the user said, or else the default.
inline std::filesystem::path PathOr(const std::string& said,
                                    const std::filesystem::path& otherwise) {
  return said.empty() ? otherwise : std::filesystem::path(said);
}

}  // namespace rgbdt
