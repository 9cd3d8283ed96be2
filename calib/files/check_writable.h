#pragma once

#include <filesystem>

namespace rgbdt {

/// So that long work is not begun for nothing: throws InputError, with the system's reason, where
/// the file `path` could not be written now, because a folder has its name, its folder (or the one
/// in which that is to be made) may not be written, or the disk is full. Leaves nothing behind and
/// makes no folder.
void CheckWritable(const std::filesystem::path& path);

}  // namespace rgbdt
