#include "calib/fuse/radiometry.h"

#include <cmath>

#include "tests/unit/matchers.h"

namespace rgbdt {
namespace {

Radiometry Linear(double gain, double offset) {
  Radiometry r;
  r.kind = Radiometry::Kind::kLinear;
  r.gain = gain;
  r.offset = offset;
  return r;
}

// Constants of the order that FLIR's cameras give.
Radiometry Planck() {
  Radiometry r;
  r.kind = Radiometry::Kind::kPlanck;
  r.r = 16500;
  r.b = 1428;
  r.f = 1;
  r.o = 340;
  return r;
}

double Fourth(double x) { return std::pow(x, 4); }

TEST(KelvinOf, NoRadiometryNoTemperature) { EXPECT_TRUE(std::isnan(KelvinOf({}, 7000))); }

TEST(KelvinOf, LinearIsGainTimesCountsPlusOffset) {
  EXPECT_DOUBLE_EQ(KelvinOf(Linear(0.04, 0), 7500), 300);  // FLIR Ax5, high resolution
  EXPECT_DOUBLE_EQ(KelvinOf(Linear(0.4, 0), 750), 300);    // FLIR Ax5, low resolution
  EXPECT_DOUBLE_EQ(KelvinOf(Linear(0.01, 250), 5000), 300);
}

TEST(KelvinOf, PlanckIsItsFormula) {
  // Counts that the forward formula gives: S = R / (exp(B / T) - F) + O.
  const Radiometry r = Planck();
  for (const double kelvin : {233.15, 273.15, 300.0, 373.15}) {
    const double counts = r.r / (std::exp(r.b / kelvin) - r.f) + r.o;
    EXPECT_NEAR(KelvinOf(r, counts), kelvin, 1e-9);
  }
  // And F is not just one.
  Radiometry other = r;
  other.f = 1.5;
  EXPECT_DOUBLE_EQ(KelvinOf(other, 500), 1428 / std::log(16500.0 / 160 + 1.5));
}

TEST(KelvinOf, CountsThatNoTemperatureGivesHaveNone) {
  EXPECT_TRUE(std::isnan(KelvinOf(Planck(), 340)));         // S = O: no radiation at all
  EXPECT_TRUE(std::isnan(KelvinOf(Planck(), 0)));           // below it
  EXPECT_TRUE(std::isnan(KelvinOf(Linear(1, -300), 200)));  // below absolute zero
  EXPECT_TRUE(std::isnan(KelvinOf(Linear(1, 0), std::nan(""))));
}

// What the camera would see of a grey surface, by Stefan-Boltzmann, comes back as its temperature.
TEST(KelvinOf, WhatIsMirroredIsTakenOff) {
  for (const double emissivity : {0.5, 0.95, 0.999}) {
    for (const double kelvin : {270.0, 300.0, 340.0}) {
      Radiometry r = Linear(0.01, 0);
      r.emissivity = emissivity;
      r.reflected_temperature_k = 255;  // a cold sky
      const double apparent =
          std::pow(emissivity * Fourth(kelvin) + (1 - emissivity) * Fourth(255), 0.25);
      EXPECT_NEAR(KelvinOf(r, apparent / 0.01), kelvin, 1e-9);
      EXPECT_LT(apparent, kelvin);
    }
  }
}

TEST(KelvinOf, SurroundingsAsWarmAsTheSurfaceChangeNothing) {
  Radiometry r = Linear(1, 0);
  r.emissivity = 0.6;
  r.reflected_temperature_k = 300;
  EXPECT_NEAR(KelvinOf(r, 300), 300, 1e-10);
}

TEST(KelvinOf, WithoutAReflectedTemperatureTheApparentOneStands) {
  Radiometry r = Linear(1, 0);
  r.emissivity = 0.6;
  EXPECT_DOUBLE_EQ(KelvinOf(r, 300), 300);
  r.emissivity = 1;
  r.reflected_temperature_k = 255;
  EXPECT_DOUBLE_EQ(KelvinOf(r, 300), 300);
}

TEST(KelvinOf, MoreMirroredThanSeenHasNoTemperature) {
  Radiometry r = Linear(1, 0);
  r.emissivity = 0.1;
  r.reflected_temperature_k = 300;
  EXPECT_TRUE(std::isnan(KelvinOf(r, 250)));  // 0.9 * 300^4 alone is more than 250^4
}

}  // namespace
}  // namespace rgbdt
