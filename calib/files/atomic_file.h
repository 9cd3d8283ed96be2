#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace rgbdt {

/// Writes `bytes` so that `path` holds either what it held before or all of the new content, never
/// a part: temporary name in the same folder, fsync, rename. Creates the folders above it. Throws
/// InputError with the path and the system's reason.
void WriteFileAtomically(const std::filesystem::path& path, const std::string& bytes);

/// The same of a file too large to be held at once, piece by piece: `path` holds what it held
/// before until Commit. One that is never committed is gone with its owner. All throw as above.
class AtomicFile {
 public:
  explicit AtomicFile(std::filesystem::path path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  void Write(std::string_view bytes);
  void Commit();

 private:
  std::filesystem::path path_, temporary_;
  int descriptor_ = -1;
};

/// Renames a file or a folder, so that the new name survives a power cut. Throws InputError with
/// both paths and the system's reason.
void Rename(const std::filesystem::path& from, const std::filesystem::path& to);

/// Files larger than this are refused before they are read, whatever they hold.
inline constexpr std::uintmax_t kMostTextBytes = std::uintmax_t{256} << 20;
inline constexpr std::uintmax_t kMostImageBytes = std::uintmax_t{512} << 20;
inline constexpr std::uintmax_t kMostPointsBytes = std::uintmax_t{4} << 30;

/// The bytes of a regular file of at most `most_bytes`, or its first ones alone. Never
/// waits, as for a pipe that nobody writes to. Throws InputError with the path and the reason.
std::string ReadWholeFile(const std::filesystem::path& path,
                          std::uintmax_t most_bytes = kMostTextBytes);
std::string ReadFileHead(const std::filesystem::path& path, std::size_t head_bytes);

}  // namespace rgbdt
