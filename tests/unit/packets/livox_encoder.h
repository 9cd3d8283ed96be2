#pragma once

// A made-up Livox, by the tables of its protocol's page; none of the driver's code.

#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

namespace rgbdt::test {

struct LivoxEncoder {
  bool sdk1 = false;  ///< an Avia's; otherwise a Mid-360's
  int type = 1;       ///< of points
  int time_type = 0;
  std::int64_t first_ns = 5'000'000'000;  ///< the first packet's stamp

  int returns() const { return !sdk1 ? 1 : type == 4 || type == 5 ? 2 : type >= 7 ? 3 : 1; }
  int beams() const { return !sdk1 || returns() == 1 ? 96 : returns() == 2 ? 48 : 30; }
  int PacketsPerSecond() const { return sdk1 ? 240'000 / beams() : 2000; }
  std::int64_t period_us() const { return 1'000'000 / PacketsPerSecond(); }
  double step_us() const { return sdk1 ? 1e6 / 240'000 : 5; }

  /// Return `k` of a beam: [mm]; whole centimetres, so that each type holds it. Every seventh beam
  /// returns nothing, every fifth is noise; of several returns the middle one is the brightest.
  void Place(int beam, int k, int mm[3]) const {
    const bool nothing = beam % 7 == 0;
    mm[0] = nothing ? 0 : 2000 + 10 * beam + 1000 * k;
    mm[1] = nothing ? 0 : 10 * (beam % 50) - 250;
    mm[2] = nothing ? 0 : -300 + 10 * (beam % 60);
  }
  int Reflectivity(int beam, int k) const { return 10 + beam % 100 + (k == 1 ? 100 : 0); }
  int Tag(int beam) const { return beam % 5 == 0 ? 0x04 : 0x10; }

  std::vector<std::uint8_t> Packet(int number) const {
    std::vector<std::uint8_t> b;
    const std::int64_t stamp = first_ns + 1000 * period_us() * number;
    if (sdk1) {
      b = {5,
           1,
           1,
           0,
           0,
           0,
           0,
           0,
           static_cast<std::uint8_t>(time_type),
           static_cast<std::uint8_t>(type)};
    } else {
      const int sizes[] = {0, 14, 8, 10};
      b = {0};
      Add(36 + 96 * sizes[type], 2, &b);
      Add(4750, 2, &b);  // [0.1 us]: 95 steps of 5 us
      Add(96, 2, &b);
      Add(number, 2, &b);
      b.push_back(0);
      b.push_back(static_cast<std::uint8_t>(type));
      b.push_back(static_cast<std::uint8_t>(time_type));
      b.resize(28);
    }
    Add(stamp, 8, &b);
    for (int beam = 0; beam < beams(); ++beam) AddBeam(beam, &b);
    return b;
  }

  static void Add(std::int64_t value, int count, std::vector<std::uint8_t>* to) {
    for (int i = 0; i < count; ++i) to->push_back(static_cast<std::uint8_t>(value >> (8 * i)));
  }

 private:
  bool shared() const { return sdk1 && (type == 5 || type == 8); }
  void AddBeam(int beam, std::vector<std::uint8_t>* b) const {
    int mm[3];
    Place(beam, 0, mm);
    const double range = std::hypot(mm[0], std::hypot(mm[1], mm[2]));
    const double theta = range > 0 ? std::acos(mm[2] / range) : 0, phi = std::atan2(mm[1], mm[0]);
    const auto hundredths = [](double rad) {
      const double turn = rad < 0 ? rad + 2 * M_PI : rad;
      return std::llround(turn * 18000 / M_PI);
    };
    if (shared()) {
      Add(hundredths(theta), 2, b);
      Add(hundredths(phi), 2, b);
    }
    for (int k = 0; k < returns(); ++k) {
      Place(beam, k, mm);
      if (shared() || type == 3) {
        Add(range > 0 ? std::llround(range) + 1000 * k : 0, 4, b);
        if (type == 3) {
          Add(hundredths(theta), 2, b);
          Add(hundredths(phi), 2, b);
        }
      } else {
        const bool low = !sdk1 && type == 2;
        for (const int m : mm) Add(low ? m / 10 : m, low ? 2 : 4, b);
      }
      b->push_back(static_cast<std::uint8_t>(Reflectivity(beam, k)));
      b->push_back(static_cast<std::uint8_t>(Tag(beam)));
    }
  }
};

}  // namespace rgbdt::test
