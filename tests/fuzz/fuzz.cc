#include "tests/fuzz/fuzz.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <stdexcept>

namespace rgbdt::fuzz {

void Require(bool holds, const std::string& what) {
  if (holds) return;
  std::fprintf(stderr, "expected %s\n", what.c_str());
  std::abort();
}

std::uint8_t Input::Byte() {
  if (left_ == 0) return 0;
  --left_;
  return *at_++;
}

std::uint16_t Input::Word() {
  const unsigned high = Byte();
  return static_cast<std::uint16_t>(high << 8 | Byte());
}

std::string Input::Take(std::size_t size) {
  size = std::min(size, left_);
  std::string bytes(at_, at_ + size);
  bytes.shrink_to_fit();
  at_ += size;
  left_ -= size;
  return bytes;
}

ScratchFile::ScratchFile(const std::string& name) {
  std::string folder = (std::filesystem::temp_directory_path() / "rgbdt-fuzz-XXXXXX").string();
  if (mkdtemp(folder.data()) == nullptr) throw std::runtime_error("cannot make " + folder);
  path_ = std::filesystem::path(folder) / name;
}

ScratchFile::~ScratchFile() {
  std::error_code ignored;
  std::filesystem::remove_all(folder(), ignored);
}

void ScratchFile::Write(const std::string& bytes) const {
  std::ofstream file(path_, std::ios::binary | std::ios::trunc);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!file.flush()) throw std::runtime_error("cannot write " + path_.string());
}

}  // namespace rgbdt::fuzz
