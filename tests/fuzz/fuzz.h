#pragma once

// What the fuzz targets share. A target is one source that defines LLVMFuzzerTestOneInput: it hands
// an input to one parser, as hostile bytes would reach it. What is bad must end in an InputError;
// anything else ends the process, and so does what Require() finds wrong with what was read.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "calib/model/errors.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace rgbdt::fuzz {

/// Ends the process, saying `what`, where it does not hold.
void Require(bool holds, const std::string& what);

/// Runs `parse`. An InputError is a good end where it says something, in one line.
template <typename Parse>
void Try(Parse parse) {
  try {
    parse();
  } catch (const InputError& error) {
    const std::string_view what = error.what();
    Require(!what.empty() && what.find('\n') == std::string_view::npos,
            "an error in one line; it says: " + std::string(what));
  }
}

/// An input, taken apart from its front.
class Input {
 public:
  Input(const std::uint8_t* data, std::size_t size) : at_(data), left_(size) {}

  bool empty() const { return left_ == 0; }
  /// 0 where nothing is left.
  std::uint8_t Byte();
  /// Big-endian.
  std::uint16_t Word();
  /// At most `size` bytes, in memory of just that size, so that a read past them is seen.
  std::string Take(std::size_t size);
  /// A piece whose length is the word before it.
  std::string Piece() { return Take(Word()); }
  std::string Rest() { return Take(left_); }

 private:
  const std::uint8_t* at_;
  std::size_t left_;
};

inline const std::uint8_t* Data(const std::string& bytes) {
  return reinterpret_cast<const std::uint8_t*>(bytes.data());
}

/// A file for parsers that take a path. It holds one input after the other and goes at the end.
class ScratchFile {
 public:
  /// `name` is what the file is called, in a folder of its own.
  explicit ScratchFile(const std::string& name);
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;
  ~ScratchFile();

  void Write(const std::string& bytes) const;
  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path folder() const { return path_.parent_path(); }

 private:
  std::filesystem::path path_;
};

}  // namespace rgbdt::fuzz
