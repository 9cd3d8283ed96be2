#include "services/drivers/hesai/hesai_sensors.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rgbdt::hesai {
namespace {

constexpr double kNever = std::numeric_limits<double>::quiet_NaN();

std::vector<double> Microseconds(const std::vector<int>& ns) {
  std::vector<double> us(ns.size());
  std::transform(ns.begin(), ns.end(), us.begin(), [](int t) { return 1e-3 * t; });
  return us;
}

// Pandar40P user manual, appendix on absolute time.
Sensor Pandar40P() {
  Sensor s;
  s.name = "Pandar40P";
  s.channels = 40;
  s.blocks = 10;
  s.block_head_bytes = 4;
  s.beam_bytes = 3;
  s.stamp_at = 10;
  s.mode_at = 14;
  s.date_at = 16;
  s.first_year = 2000;
  s.tail_bytes = 22;
  s.more_bytes = 4;
  s.block_us = 55.56;
  s.last_block_us = -28.58;
  s.channel_us =
      Microseconds({-42220, -28470, -16040, -3620,  -45490, -31740, -47460, -54670, -20620, -33710,
                    -40910, -8190,  -20620, -27160, -50730, -8190,  -14740, -36980, -45490, -52700,
                    -23890, -31740, -38950, -11470, -18650, -25190, -48760, -6230,  -12770, -35010,
                    -21920, -9500,  -43520, -29770, -17350, -4920,  -42220, -28470, -16040, -3620});
  return s;
}

// Pandar64 user manual, likewise.
Sensor Pandar64() {
  Sensor s = Pandar40P();
  s.name = "Pandar64";
  s.channels = 64;
  s.blocks = 6;
  s.head_bytes = 8;
  s.block_head_bytes = 2;
  s.last_block_us = -42.58;
  s.channel_us = Microseconds(
      {-23180, -21876, -20572, -19268, -17964, -16660, -11444, -46796, -7532,  -36956, -50732,
       -54668, -40892, -44828, -31052, -34988, -48764, -52700, -38924, -42860, -29084, -33020,
       -46796, -25148, -36956, -50732, -27116, -40892, -44828, -31052, -34988, -48764, -25148,
       -38924, -42860, -29084, -33020, -52700, -6228,  -54668, -15356, -27116, -10140, -23180,
       -4924,  -21876, -14052, -17964, -8836,  -19268, -3620,  -20572, -12748, -16660, -7532,
       -11444, -6228,  -15356, -10140, -4924,  -3620,  -14052, -8836,  -12748});
  return s;
}

// PandarXT manual, appendix on absolute time. The XT-32M has channels in two halves, side by side.
Sensor PandarXt(std::size_t channels, bool is_m = false) {
  Sensor s;
  s.name = "PandarXT-" + std::to_string(channels) + (is_m ? "M" : "");
  s.channels = channels;
  s.blocks = is_m ? 6 : 8;
  s.version = 0x0601;
  s.head_bytes = 12;
  s.beam_bytes = 4;
  s.mode_at = 10;
  s.date_at = 13;
  s.stamp_at = 19;
  s.tail_bytes = 24;
  s.more_bytes = 4;
  s.block_us = 50;
  s.last_block_us = 5.632;
  for (std::size_t i = 0; i < channels; ++i) {
    const std::size_t slot = i * 32 / channels;  // of those that the larger one has
    s.channel_us.push_back(
        0.368 + (is_m ? 2.888 * static_cast<double>(i % 16) : 1.512 * static_cast<double>(slot)));
  }
  return s;
}

// PandarQT manual; its correction file of firing times.
Sensor PandarQt64() {
  Sensor s;
  s.name = "PandarQT-64";
  s.channels = 64;
  s.blocks = 4;
  s.version = 0x0301;
  s.head_bytes = 12;
  s.beam_bytes = 4;
  s.stamp_at = 12;
  s.mode_at = 16;
  s.date_at = 18;
  s.tail_bytes = 24;
  s.more_bytes = 4;
  s.from_first = true;
  s.block_us = 500.0 / 3;
  s.last_block_us = 25.71;
  s.channel_us = Microseconds(
      {2310,   4370,   6430,   8490,   10540,  12600,  14660,  16710,  19160,  21220,  23280,
       25340,  27390,  29450,  31500,  33560,  36610,  38670,  40730,  42780,  44840,  46900,
       48950,  51010,  53450,  55520,  57580,  59630,  61690,  63740,  65800,  67860,  70900,
       72970,  75020,  77080,  79140,  81190,  83250,  85300,  87750,  89820,  91870,  93930,
       95980,  98040,  100100, 102150, 105200, 107260, 109320, 111380, 113430, 115490, 117540,
       119600, 122050, 124110, 126170, 128220, 130280, 132340, 134390, 136450});
  return s;
}

// What the 128 channels' packets have behind their head: protocols 1.4 and 3.2.
Sensor Of128(const std::string& name, int version) {
  Sensor s;
  s.name = name;
  s.channels = 128;
  s.blocks = 2;
  s.version = version;
  s.head_bytes = 12;
  s.beam_bytes = 3;
  s.checked = true;
  s.mode_at = 12;
  s.date_at = 15;
  s.stamp_at = 21;
  s.tail_bytes = 26;
  s.more_bytes = 4 + 22 + 4 + 32;
  return s;
}

// QT128C2X manual; its correction file of firing times: 32 triples of channels, in the order of
// `kInGroup` or, where they are the other group's, with its octets swapped.
Sensor PandarQt128() {
  constexpr std::size_t kInGroup[] = {3, 6, 11, 14, 19, 22, 27, 30, 1, 8, 9,  16, 17, 24, 25, 32,
                                      2, 7, 10, 15, 18, 23, 26, 31, 4, 5, 12, 13, 20, 21, 28, 29};
  Sensor s = Of128("PandarQT-128", 0x0302);
  s.beam_flags = 0x10;
  s.turn_at = 5;
  s.from_first = true;
  s.block_us = 111.11;
  s.last_block_us = 9;
  for (std::vector<double>& us : s.loop_us) us.assign(s.channels, kNever);
  for (std::size_t n = 0; n < 32; ++n) {
    const std::size_t one = kInGroup[n] - 1, other = kInGroup[n ^ 8] - 1;
    const double first = 0.6 + 3.168 * static_cast<double>(n), second = first + 0.856;
    s.loop_us[0][96 + one] = s.loop_us[1][64 + other] = first;
    s.loop_us[0][64 + other] = s.loop_us[1][96 + one] = second;
    s.loop_us[0][32 + one] = s.loop_us[1][other] = second + 0.856;
  }
  return s;
}

// Pandar128E3X manual; its correction file of firing times.
const Slots& SlotsOf128E3X() {
  static const Slots slots = [] {
    Slots s;
    s.us[0] = Microseconds({776, 2431, 4436, 6441});
    s.us[1] = Microseconds({776, 2781, 4786, 6441});
    s.us[2] = Microseconds({776, 2781, 4436, 6091});
    s.us[3] = Microseconds({776, 2431, 4086, 6091});
    constexpr double kAsideUs[] = {0, 0.35, 0, -0.35};
    for (std::size_t state = 0; state < 4; ++state) {
      for (int i = 0; i < 8; ++i) s.us[state].push_back(8.096 + 2.285 * i + kAsideUs[state]);
    }
    s.of_channels =
        "24012536701347546360157629babdd8aa9fcfbbdcae8e99e88daaffcecb9bcc"
        "8dd9f9ea9be8dc8dfffce8aeb102375041126453254637760261570423751034";
    s.late = {'4', '5', '6', '7', '8', '9', 'b', 'f'};
    s.near_m = 2.85;
    s.near = {{0, 1, 5.201},   {0, 3, 1.541},   {0, 18, 7.206},  {0, 21, 3.196},  {0, 40, 27.056},
              {0, 75, 23.201}, {0, 90, 3.676},  {0, 105, 5.681}, {1, 6, 4.026},   {1, 9, 7.206},
              {1, 15, 3.546},  {1, 26, 12.126}, {1, 47, 27.406}, {1, 102, 2.021}, {1, 111, 7.686},
              {1, 120, 1.541}, {2, 12, 7.336},  {2, 33, 14.061}, {2, 54, 27.056}, {2, 93, 6.856},
              {2, 96, 2.021},  {2, 99, 3.546},  {2, 114, 5.201}, {2, 126, 1.541}, {3, 24, 4.851},
              {3, 61, 26.706}, {3, 68, 11.426}, {3, 82, 25.136}, {3, 108, 5.331}, {3, 117, 3.196},
              {3, 123, 6.856}, {3, 128, 1.541}};
    return s;
  }();
  return slots;
}

// OT128 manual; its correction file of firing times.
const Slots& SlotsOfOt128() {
  static const Slots slots = [] {
    Slots s;
    s.us[0] =
        Microseconds({0, 6289, 12578, 18867, 1653, 3971, 7942, 10260, 14231, 16549, 20520, 22838});
    s.us[1] = s.us[3] = s.us[0];
    s.us[2] =
        Microseconds({0, 6289, 14722, 21011, 1653, 3971, 7942, 10260, 16375, 18693, 22664, 24982});
    s.of_channels =
        "753164207531642075316420edbde9cacab889ffcdeabd89bfc9eacd8abf89ef"
        "cdeabd89bfc9eacd8abf89ef7531642075316420753164207531642075316420";
    s.late = {'4', '5', '6', '7'};
    return s;
  }();
  return slots;
}

constexpr double kHalfUs = 27.778;  // of a column of standard resolution

Sensor Pandar128E3X() {
  Sensor s = Of128("Pandar128E3X", 0x0104);
  s.last_kind = 127;
  s.beam_flags = 0x70;
  s.turn_at = 9;
  s.block_us = 2 * kHalfUs;
  s.last_block_us = 3.148;
  s.slots = &SlotsOf128E3X();
  return s;
}

Sensor Ot128() {
  Sensor s = Pandar128E3X();
  s.name = "OT128";
  s.first_kind = 128;
  s.last_kind = 136;
  s.last_block_us = 0;
  s.no_return = 3;
  s.slots = &SlotsOfOt128();
  return s;
}

// In standard resolution a column is two of high resolution: early slots fire in the first of them,
// late ones in the second.
Firing FiringOf(const Slots& slots, std::size_t state, bool high_resolution) {
  Firing firing;
  firing.near_m = slots.near_m;
  const std::string codes = slots.of_channels;
  for (const char code : codes) {
    const bool is_late = !high_resolution &&
                         std::find(slots.late.begin(), slots.late.end(), code) != slots.late.end();
    const std::size_t of = high_resolution ? state % 4 : 2 * (state % 2) + (is_late ? 1 : 0);
    const auto slot = static_cast<std::size_t>(code <= '9' ? code - '0' : code - 'a' + 10);
    const bool fires = slot >= 2 * Slots::kOuter || slot / Slots::kOuter == of % 2;
    const std::size_t place =
        slot >= 2 * Slots::kOuter ? slot - Slots::kOuter : slot % Slots::kOuter;
    firing.us.push_back(fires ? slots.us[of][place] + (is_late ? kHalfUs : 0) : kNever);
  }
  firing.near_us = firing.us;
  for (const Slots::Near& near : slots.near) {
    const std::size_t column = high_resolution ? near.state : near.state / 2;
    const double later = !high_resolution && near.state % 2 == 1 ? kHalfUs : 0;
    const std::size_t now = high_resolution ? state % 4 : state % 2;
    if (column == now) firing.near_us[near.channel - 1] = near.us + later;
  }
  return firing;
}

}  // namespace

const std::vector<Sensor>& Sensors() {
  static const std::vector<Sensor> sensors = {Pandar40P(),   Pandar64(),         PandarQt64(),
                                              PandarQt128(), Pandar128E3X(),     Ot128(),
                                              PandarXt(32),  PandarXt(32, true), PandarXt(16)};
  return sensors;
}

Firing FiringOf(const Sensor& sensor, std::size_t turn, bool high_resolution) {
  if (sensor.slots != nullptr) return FiringOf(*sensor.slots, turn, high_resolution);
  Firing firing;
  firing.us = sensor.loop_us[0].empty() ? sensor.channel_us : sensor.loop_us[turn % 2];
  return firing;
}

}  // namespace rgbdt::hesai
