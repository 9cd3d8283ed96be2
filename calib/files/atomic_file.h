#pragma once

#include <filesystem>
#include <string>

namespace rgbdt {

/// Writes `bytes` so that `path` holds either what it held before or all of the new content, never
/// a part: temporary name in the same folder, fsync, rename. Creates the folders above it. Throws
/// InputError with the path and the system's reason.
void WriteFileAtomically(const std::filesystem::path& path, const std::string& bytes);

/// The file's bytes. Throws InputError with the path and the system's reason.
std::string ReadWholeFile(const std::filesystem::path& path);

}  // namespace rgbdt
