#include "calib/files/points/internal/laz_arithmetic.h"

#include <algorithm>
#include <utility>

namespace rgbdt::laz {
namespace {

constexpr std::uint32_t kSymbolShift = 15, kBitShift = 13;  // of shares
constexpr std::uint32_t kLeastLength = 1 << 24;             // shorter: the top byte is decided

}  // namespace

SymbolModel::SymbolModel(std::uint32_t symbols)
    : counts_(symbols, 1), before_(symbols), cycle_(symbols) {
  Update();
  left_ = cycle_ = (symbols + 6) / 2;  // the first update soon
}

void SymbolModel::Update() {
  total_ += cycle_;
  if (total_ > 1U << kSymbolShift) {
    total_ = 0;
    for (std::uint32_t& count : counts_) total_ += count = (count + 1) / 2;
  }
  const std::uint32_t scale = (1U << 31) / total_;
  std::uint32_t sum = 0;
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    before_[i] = (scale * sum) >> (31 - kSymbolShift);
    sum += counts_[i];
  }
  left_ = cycle_ = std::min(5 * cycle_ / 4, 8 * (Symbols() + 6));
}

void BitModel::Update() {
  total_ += cycle_;
  if (total_ > 1U << kBitShift) {
    total_ = (total_ + 1) / 2;
    zeros_ = (zeros_ + 1) / 2;
    if (zeros_ == total_) ++total_;
  }
  zeros_share_ = (zeros_ * ((1U << 31) / total_)) >> (31 - kBitShift);
  left_ = cycle_ = std::min(5 * cycle_ / 4, 64U);
}

void ArithmeticEncoder::Encode(std::uint32_t symbol, SymbolModel* model) {
  const std::uint32_t unit = length_ >> kSymbolShift;
  const std::uint32_t low = model->Before(symbol) * unit;
  // What the division left over is the last symbol's.
  const std::uint32_t high =
      symbol + 1 == model->Symbols() ? length_ : model->Before(symbol + 1) * unit;
  Narrow(low, high - low);
  model->Count(symbol);
}

void ArithmeticEncoder::EncodeBit(bool bit, BitModel* model) {
  const std::uint32_t zeros = model->Zeros() * (length_ >> kBitShift);
  Narrow(bit ? zeros : 0, bit ? length_ - zeros : zeros);
  model->Count(bit);
}

void ArithmeticEncoder::EncodeRaw(std::uint32_t bits, std::uint32_t value) {
  if (bits > 19) {  // the interval holds no more at a time
    EncodeRaw(16, value & 0xffff);
    bits -= 16;
    value >>= 16;
  }
  const std::uint32_t unit = length_ >> bits;
  Narrow(value * unit, unit);
}

std::string ArithmeticEncoder::Finish() {
  // A number within the interval, as short as may be, and zeros for the decoder, which reads four
  // bytes ahead.
  const bool wide = length_ > 2 * kLeastLength;
  Narrow(wide ? kLeastLength : kLeastLength / 2, wide ? kLeastLength / 2 : kLeastLength / 512);
  bytes_.append(wide ? 3 : 2, '\0');
  return std::move(bytes_);
}

void ArithmeticEncoder::Narrow(std::uint32_t offset, std::uint32_t length) {
  base_ += offset;
  if (base_ < offset) Carry();
  length_ = length;
  while (length_ < kLeastLength) {
    bytes_.push_back(static_cast<char>(base_ >> 24));
    base_ <<= 8;
    length_ <<= 8;
  }
}

void ArithmeticEncoder::Carry() {
  auto byte = bytes_.rbegin();
  for (; *byte == '\xff'; ++byte) *byte = 0;
  ++*byte;
}

}  // namespace rgbdt::laz
