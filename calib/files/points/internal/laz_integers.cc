#include "calib/files/points/internal/laz_integers.h"

#include <algorithm>

namespace rgbdt::laz {
namespace {

constexpr std::uint32_t kHighBits = 8;

// value - predicted, wrapped to the numbers of so many bits.
std::int32_t Difference(std::int32_t predicted, std::int32_t value, std::uint32_t bits) {
  const auto difference = static_cast<std::uint32_t>(value) - static_cast<std::uint32_t>(predicted);
  return bits == 16 ? static_cast<std::int16_t>(difference) : static_cast<std::int32_t>(difference);
}

// The least k with -2^k < difference <= 2^k.
std::uint32_t WidthOf(std::int32_t difference) {
  auto size = static_cast<std::uint32_t>(difference > 0 ? difference - 1 : difference);
  if (difference <= 0) size = 0U - size;
  std::uint32_t width = 0;
  for (; size > 0; size >>= 1) ++width;
  return width;
}

}  // namespace

IntegerModel::IntegerModel(std::uint32_t bits, std::uint32_t contexts)
    : bits_(bits), widths_(contexts, SymbolModel(bits + 1)) {
  high_bits_.reserve(bits);
  for (std::uint32_t width = 1; width <= bits; ++width) {
    high_bits_.emplace_back(1U << std::min(width, kHighBits));
  }
}

void IntegerModel::Encode(std::int32_t predicted, std::int32_t value, std::uint32_t context,
                          ArithmeticEncoder* out) {
  const std::int32_t difference = Difference(predicted, value, bits_);
  width_ = WidthOf(difference);
  out->Encode(width_, &widths_[context]);
  if (width_ == 32) return;  // -2^31 alone
  if (width_ == 0) return out->EncodeBit(difference == 1, &one_bit_);
  // The numbers of this width are -2^k + 1 to -2^(k-1), and 2^(k-1) + 1 to 2^k: 0 to 2^k - 1.
  const auto number =
      static_cast<std::uint32_t>(difference) + (difference < 0 ? (1U << width_) - 1 : 0U - 1);
  const std::uint32_t low = width_ > kHighBits ? width_ - kHighBits : 0;
  out->Encode(number >> low, &high_bits_[width_ - 1]);
  if (low > 0) out->EncodeRaw(low, number & ((1U << low) - 1));
}

}  // namespace rgbdt::laz
