#pragma once

// Integers as LAZ codes them: how far they are from a prediction. First how many bits that takes (a
// model for each context), then these bits, the highest eight by a model for each number of bits.

#include <cstdint>
#include <vector>

#include "calib/files/points/internal/laz_arithmetic.h"

namespace rgbdt::laz {

class IntegerModel {
 public:
  /// Of numbers of 16 or 32 bits, which wrap around.
  IntegerModel(std::uint32_t bits, std::uint32_t contexts);

  void Encode(std::int32_t predicted, std::int32_t value, std::uint32_t context,
              ArithmeticEncoder* out);
  /// The bits that the last one took, 0 to 32.
  std::uint32_t Width() const { return width_; }

 private:
  std::uint32_t bits_, width_ = 0;
  std::vector<SymbolModel> widths_;  // by context
  BitModel one_bit_;
  std::vector<SymbolModel> high_bits_;  // by width, from 1 on
};

}  // namespace rgbdt::laz
