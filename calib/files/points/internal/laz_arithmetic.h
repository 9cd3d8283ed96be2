#pragma once

// Arithmetic coding as LAZ has it: A. Said, Introduction to Arithmetic Coding, HPL-2004-76, with an
// interval of 32 bits and models that adapt to the symbols that came before. A decoder keeps the
// same models, so every count, shift and moment of an update is part of the format.

#include <cstdint>
#include <string>
#include <vector>

namespace rgbdt::laz {

/// How likely each of 2 to 2048 symbols is. At first all are alike.
class SymbolModel {
 public:
  explicit SymbolModel(std::uint32_t symbols);

  std::uint32_t Symbols() const { return static_cast<std::uint32_t>(counts_.size()); }
  /// The share of the symbols before this one, in 1/2^15.
  std::uint32_t Before(std::uint32_t symbol) const { return before_[symbol]; }
  void Count(std::uint32_t symbol) {
    ++counts_[symbol];
    if (--left_ == 0) Update();
  }

 private:
  void Update();

  std::vector<std::uint32_t> counts_, before_;
  std::uint32_t total_ = 0, cycle_ = 0, left_ = 0;
};

/// How likely 0 is.
class BitModel {
 public:
  std::uint32_t Zeros() const { return zeros_share_; }  ///< in 1/2^13
  void Count(bool bit) {
    if (!bit) ++zeros_;
    if (--left_ == 0) Update();
  }

 private:
  void Update();

  std::uint32_t zeros_ = 1, total_ = 2, zeros_share_ = 1 << 12, cycle_ = 4, left_ = 4;
};

class ArithmeticEncoder {
 public:
  void Encode(std::uint32_t symbol, SymbolModel* model);
  void EncodeBit(bool bit, BitModel* model);
  /// The lowest `bits` (1 to 32) of a value of which nothing is known.
  void EncodeRaw(std::uint32_t bits, std::uint32_t value);
  /// All bytes. Nothing is encoded after that.
  std::string Finish();

 private:
  void Narrow(std::uint32_t offset, std::uint32_t length);
  void Carry();

  std::string bytes_;
  std::uint32_t base_ = 0, length_ = 0xffffffff;
};

}  // namespace rgbdt::laz
