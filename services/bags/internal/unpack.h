#pragma once

// What chunks and messages are packed with.

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace rgbdt::bags {

/// Unpacks what is to give exactly `unpacked` bytes. `compression`: "zstd", "lz4" (frames) or
/// "bz2";
/// "" and "none": as it is. Throws InputError, without the file's name: a compression that is not
/// known, an `unpacked` above kMostBagBytes (before memory is taken), damaged data, other than so
/// many bytes.
void Unpack(const std::string& compression, const std::uint8_t* packed, std::size_t size,
            std::uint64_t unpacked, std::vector<std::uint8_t>* out);

/// How much all of a bag's chunks may unpack to. No recorder packs as tightly as one who forges:
/// 100 bytes of bz2 give 128 MiB, and a file of a megabyte hours of work.
class UnpackBudget {
 public:
  explicit UnpackBudget(std::int64_t file_bytes);
  /// Before so many bytes are unpacked. Throws InputError where these are more than are left.
  void Spend(std::uint64_t bytes);

 private:
  std::uint64_t left_;
};

/// Whether this begins as zstd's frames do.
bool IsZstd(const std::uint8_t* bytes, std::size_t size);

/// The size that a zstd frame says it unpacks to. Throws InputError where it says none.
std::uint64_t ZstdSize(const std::uint8_t* bytes, std::size_t size);

}  // namespace rgbdt::bags
