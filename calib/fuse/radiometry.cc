#include "calib/fuse/radiometry.h"

#include <cmath>
#include <limits>

namespace rgbdt {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

double Apparent(const Radiometry& r, double counts) {
  switch (r.kind) {
    case Radiometry::Kind::kNone:
      return kNone;
    case Radiometry::Kind::kLinear:
      return r.gain * counts + r.offset;
    case Radiometry::Kind::kPlanck: {
      const double argument = r.r / (counts - r.o) + r.f;
      return argument > 1 ? r.b / std::log(argument) : kNone;
    }
  }
  return kNone;
}

double Fourth(double x) { return x * x * x * x; }

}  // namespace

double KelvinOf(const Radiometry& r, double counts) {
  const double apparent = Apparent(r, counts);
  if (!(apparent > 0)) return kNone;
  const bool mirrors = r.emissivity > 0 && r.emissivity < 1 && r.reflected_temperature_k > 0;
  if (!mirrors) return apparent;
  const double own =
      (Fourth(apparent) - (1 - r.emissivity) * Fourth(r.reflected_temperature_k)) / r.emissivity;
  return own > 0 ? std::sqrt(std::sqrt(own)) : kNone;
}

}  // namespace rgbdt
