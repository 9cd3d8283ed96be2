#include "calib/files/points/internal/laz_gps_times.h"

#include <algorithm>
#include <cmath>

namespace rgbdt::laz {
namespace {

// Symbols of multiples: 0 to 500; then -1 to -10; then a whole time, and three for another run.
constexpr std::int32_t kMost = 500, kLeast = -10, kWhole = 511;
// The same of a run without a step: the step itself; a whole time; three for another run.
constexpr std::int32_t kFirstStep = 0, kFirstWhole = 1;
constexpr std::uint32_t kWholeContext = 8;

std::uint32_t SymbolOf(std::int32_t multiple) {
  return static_cast<std::uint32_t>(multiple >= 0 ? multiple : kMost - multiple);
}

std::uint32_t ContextOf(std::int32_t multiple) {
  if (multiple == 0) return 7;
  if (multiple == kLeast) return 6;
  if (multiple < 0) return 5;
  if (multiple == kMost) return 4;
  return multiple == 1 ? 1 : multiple < 10 ? 2 : 3;
}

// Bits of doubles, which may be farther apart than 2^63.
std::int64_t Apart(std::int64_t time, std::int64_t last) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(time) -
                                   static_cast<std::uint64_t>(last));
}

std::int32_t UpperHalf(std::int64_t time) { return static_cast<std::int32_t>(time >> 32); }

}  // namespace

bool GpsTimes::IsNear(std::int64_t time, std::uint32_t ahead) const {
  const std::int64_t apart = Apart(time, runs_[(current_ + ahead) % 4].last);
  return apart == static_cast<std::int32_t>(apart);
}

void GpsTimes::Encode(std::int64_t time, ArithmeticEncoder* out) {
  std::uint32_t ahead = 0;
  while (ahead < 4 && !IsNear(time, ahead)) ++ahead;
  if (ahead > 0) {
    const bool steps = runs_[current_].step != 0;
    const std::uint32_t symbol = (steps ? kWhole : kFirstWhole) + ahead % 4;
    out->Encode(symbol, steps ? &multiples_ : &without_step_);
    if (ahead == 4) return EncodeWhole(time, out);
    current_ = (current_ + ahead) % 4;
  }
  EncodeStep(time, out);
}

void GpsTimes::EncodeStep(std::int64_t time, ArithmeticEncoder* out) {
  Run& run = runs_[current_];
  const auto step = static_cast<std::int32_t>(Apart(time, run.last));
  run.last = time;
  if (run.step != 0) return EncodeMultiple(step, out);
  out->Encode(kFirstStep, &without_step_);
  steps_.Encode(0, step, 0, out);
  run.step = step;
  run.unusual = 0;
}

void GpsTimes::EncodeMultiple(std::int32_t step, ArithmeticEncoder* out) {
  Run& run = runs_[current_];
  const double ratio =
      std::clamp<double>(std::round(static_cast<double>(step) / run.step), kLeast, kMost);
  const auto multiple = static_cast<std::int32_t>(ratio);
  const std::int64_t predicted = std::int64_t{multiple} * run.step;
  out->Encode(SymbolOf(multiple), &multiples_);
  steps_.Encode(static_cast<std::int32_t>(predicted), step, ContextOf(multiple), out);
  if (multiple == 1) run.unusual = 0;
  if (multiple != 0 && multiple != kLeast && multiple != kMost) return;
  if (++run.unusual <= 3) return;
  run.unusual = 0;
  run.step = step;
}

void GpsTimes::EncodeWhole(std::int64_t time, ArithmeticEncoder* out) {
  steps_.Encode(UpperHalf(runs_[current_].last), UpperHalf(time), kWholeContext, out);
  out->EncodeRaw(32, static_cast<std::uint32_t>(time));
  current_ = newest_ = (newest_ + 1) % 4;
  runs_[current_] = {time, 0, 0};
}

}  // namespace rgbdt::laz
