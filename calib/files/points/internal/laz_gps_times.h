#pragma once

#include <array>
#include <cstdint>

#include "calib/files/points/internal/laz_integers.h"

namespace rgbdt::laz {

/// GPS times of one chunk (LASzip's item POINT14, version 3), as the bits of the doubles: up to
/// four runs of times, each told by multiples of its usual step.
class GpsTimes {
 public:
  explicit GpsTimes(std::int64_t first) { runs_[0].last = first; }

  /// A time that is not the one before.
  void Encode(std::int64_t time, ArithmeticEncoder* out);

 private:
  struct Run {
    std::int64_t last = 0;
    std::int32_t step = 0;
    int unusual = 0;  // steps of late
  };

  bool IsNear(std::int64_t time, std::uint32_t ahead) const;
  void EncodeStep(std::int64_t time, ArithmeticEncoder* out);
  void EncodeMultiple(std::int32_t step, ArithmeticEncoder* out);
  void EncodeWhole(std::int64_t time, ArithmeticEncoder* out);

  std::array<Run, 4> runs_;
  std::uint32_t current_ = 0, newest_ = 0;
  SymbolModel multiples_{515}, without_step_{5};
  IntegerModel steps_{32, 9};
};

}  // namespace rgbdt::laz
