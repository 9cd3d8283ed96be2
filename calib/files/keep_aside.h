#pragma once

#include <filesystem>

namespace rgbdt {

/// Before a file is written that must not take an earlier one's place: what is called so is renamed
/// FILE.1.EXT, or has the first number that is free. Returns its new name; empty: nothing is called
/// so. Throws InputError where it cannot be renamed, and where 10,000 are kept.
std::filesystem::path KeepAside(const std::filesystem::path& file);

}  // namespace rgbdt
