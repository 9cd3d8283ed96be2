#include "calib/fuse/radiometry.h"

#include <cmath>
#include <limits>

namespace rgbdt {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

double Fourth(double x) { return x * x * x * x; }

bool Mirrors(const Radiometry& r) {
  return r.emissivity > 0 && r.emissivity < 1 && r.reflected_temperature_k > 0;
}

// What is left of a signal that grows with radiance when what is mirrored is taken off.
double OwnSignal(const Radiometry& r, double seen, double mirrored) {
  return (seen - (1 - r.emissivity) * mirrored) / r.emissivity;
}

double Linear(const Radiometry& r, double counts) {
  const double apparent = r.gain * counts + r.offset;
  if (!(apparent > 0)) return kNone;
  if (!Mirrors(r)) return apparent;
  const double own = OwnSignal(r, Fourth(apparent), Fourth(r.reflected_temperature_k));
  return own > 0 ? std::sqrt(std::sqrt(own)) : kNone;
}

double Planck(const Radiometry& r, double counts) {
  double signal = counts - r.o;
  if (Mirrors(r)) {
    signal = OwnSignal(r, signal, r.r / (std::exp(r.b / r.reflected_temperature_k) - r.f));
  }
  const double argument = r.r / signal + r.f;
  return signal > 0 && argument > 1 ? r.b / std::log(argument) : kNone;
}

}  // namespace

double KelvinOf(const Radiometry& r, double counts) {
  switch (r.kind) {
    case Radiometry::Kind::kNone:
      return kNone;
    case Radiometry::Kind::kLinear:
      return Linear(r, counts);
    case Radiometry::Kind::kPlanck:
      return Planck(r, counts);
  }
  return kNone;
}

}  // namespace rgbdt
