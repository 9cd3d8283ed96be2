#include "calib/fuse/temperature_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "calib/fuse/radiometry.h"

namespace rgbdt {
namespace {

Radiometry Linear() {
  Radiometry r;
  r.kind = Radiometry::Kind::kLinear;
  r.gain = 0.04;
  return r;
}

Radiometry PlanckOfA655() {
  Radiometry r;
  r.kind = Radiometry::Kind::kPlanck;
  r.r = 366545;
  r.b = 1428;
  r.f = 1;
  r.o = -342;
  r.emissivity = 0.9;
  r.reflected_temperature_k = 280;
  return r;
}

TEST(TemperatureTable, IsTheFormula) {
  for (const Radiometry& r : {Linear(), PlanckOfA655()}) {
    const TemperatureTable table(r, 0.05);
    for (const float counts : {3000.F, 3000.25F, 7499.5F, 12000.75F}) {
      EXPECT_NEAR(table.At(counts).kelvin, KelvinOf(r, counts), 2e-4);
    }
  }
}

TEST(TemperatureTable, WithoutRadiometryAndBeyondItsCountsThereIsNone) {
  EXPECT_TRUE(std::isnan(TemperatureTable({}, 0.05).At(7000).kelvin));
  const TemperatureTable table(Linear(), 0.05);
  for (const float counts : {-1.F, 65536.F, std::nanf("")}) {
    EXPECT_TRUE(std::isnan(table.At(counts).kelvin)) << counts;
    EXPECT_TRUE(std::isnan(table.At(counts).sigma_k)) << counts;
  }
  EXPECT_NEAR(table.At(65535).kelvin, 0.04 * 65535, 1e-3);
}

TEST(TemperatureTable, ManyAtOnceAreTheSame) {
  std::vector<float> counts = {-1, 65536, std::nanf(""), 0, 65535};
  for (int i = 0; i < 40; ++i) counts.push_back(2000.F + 311.3F * static_cast<float>(i));
  for (const Radiometry& r : {Radiometry{}, Linear(), PlanckOfA655()}) {
    const TemperatureTable table(r, 0.05);
    std::vector<float> kelvin(counts.size()), sigma_k(counts.size());
    table.At(counts.data(), counts.size(), kelvin.data(), sigma_k.data());
    for (std::size_t i = 0; i < counts.size(); ++i) {
      const auto one = table.At(counts[i]);
      EXPECT_THAT(kelvin[i], testing::NanSensitiveFloatEq(one.kelvin)) << counts[i];
      EXPECT_THAT(sigma_k[i], testing::NanSensitiveFloatEq(one.sigma_k)) << counts[i];
    }
  }
}

TEST(TemperatureTable, UnknownNoiseIsUnknown) {
  const auto temperature = TemperatureTable(Linear(), 0).At(7500);
  EXPECT_NEAR(temperature.kelvin, 300, 1e-4);
  EXPECT_TRUE(std::isnan(temperature.sigma_k));
}

// Counts with the noise that the NETD stands for, whole numbers, at several temperatures.
TEST(TemperatureTable, ItsSigmaIsThatOfItsErrors) {
  constexpr double kNetd = 0.05;
  std::mt19937 engine(3);
  std::normal_distribution<double> normal;
  for (const Radiometry& r : {Linear(), PlanckOfA655()}) {
    Radiometry black = r;
    black.emissivity = 1;
    // Counts of a black body at 300 K, and 1 K more of it: by bisection, not by the inverse.
    const auto counts_of = [&](double kelvin) {
      double low = 0;
      double high = 65535;
      for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (low + high);
        const double found = KelvinOf(black, middle);
        (found < kelvin || std::isnan(found) ? low : high) = middle;
      }
      return low;
    };
    const double sigma_counts = kNetd * (counts_of(300.5) - counts_of(299.5));
    const TemperatureTable table(r, kNetd);
    for (const double kelvin : {285.0, 310.0, 340.0}) {
      const double counts = counts_of(kelvin);
      const double truth = KelvinOf(r, counts);
      double squares = 0;
      constexpr int kDraws = 20000;
      double sigma = 0;
      for (int i = 0; i < kDraws; ++i) {
        const auto seen = static_cast<float>(std::round(counts + sigma_counts * normal(engine)));
        squares += std::pow(table.At(seen).kelvin - truth, 2);
        sigma += table.At(seen).sigma_k / kDraws;
      }
      EXPECT_NEAR(std::sqrt(squares / kDraws) / sigma, 1, 0.03) << kelvin;
    }
  }
}

}  // namespace
}  // namespace rgbdt
