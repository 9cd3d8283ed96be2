#include "services/drivers/velodyne/velodyne_packets.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "calib/model/errors.h"

namespace rgbdt::velodyne {
namespace {

using Model = VelodyneDevice::Model;

// A packet: 12 blocks of flag, azimuth [0.01 degrees] and 32 returns; time; two factory bytes.
constexpr std::size_t kBlocks = 12;
constexpr std::size_t kBlockBytes = 100;
constexpr std::size_t kReturns = 32;
constexpr std::size_t kStampAt = kBlocks * kBlockBytes;
constexpr std::size_t kModeAt = kStampAt + 4;
constexpr std::size_t kProductAt = kStampAt + 5;
constexpr std::uint16_t kUpper = 0xeeff;  // and every block of sensors with up to 32 lasers
constexpr std::uint16_t kLower = 0xddff;
constexpr std::uint8_t kDual = 0x39;

std::uint16_t Word(const std::uint8_t* bytes) {
  return static_cast<std::uint16_t>(bytes[0] | bytes[1] << 8);
}

std::int64_t LongWord(const std::uint8_t* bytes) {
  return Word(bytes) + (std::int64_t{Word(bytes + 2)} << 16);
}

void RankRings(Sensor* sensor) {
  std::vector<int> order(sensor->elevation_deg.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    return sensor->elevation_deg[static_cast<std::size_t>(a)] <
           sensor->elevation_deg[static_cast<std::size_t>(b)];
  });
  sensor->ring.resize(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    sensor->ring[static_cast<std::size_t>(order[i])] = static_cast<int>(i);
  }
  sensor->azimuth_deg.resize(order.size(), 0);
}

// VLP-16 manual, table 9-1 and section 9.4: 16 * 2.304 us and 18.432 us of recharge.
Sensor Vlp16() {
  Sensor s;
  s.name = "VLP-16";
  s.model = Model::kVlp16;
  s.column_us = 55.296;
  s.period_us = 2.304;
  for (int i = 0; i < 16; ++i) s.elevation_deg.push_back(i % 2 == 0 ? i - 15 : i);
  return s;
}

// VLP-32C manual, table 9-1: elevations and azimuth offsets by laser; two lasers at once.
Sensor Vlp32c() {
  Sensor s;
  s.name = "VLP-32C";
  s.model = Model::kVlp32c;
  s.unit_m = 0.004;
  s.column_us = 55.296;
  s.period_us = 2.304;
  s.at_once = 2;
  s.elevation_deg = {-25,    -1,    -1.667, -15.639, -11.31, 0,     -0.667, -8.843,
                     -7.254, 0.333, -0.333, -6.148,  -5.333, 1.333, 0.667,  -4,
                     -4.667, 1.667, 1,      -3.667,  -3.333, 3.333, 2.333,  -2.667,
                     -3,     7,     4.667,  -2.333,  -2,     15,    10.333, -1.333};
  s.azimuth_deg = {1.4,  -4.2, 1.4,  -1.4, 1.4,  -1.4, 4.2,  -1.4, 1.4,  -4.2, 1.4,
                   -1.4, 4.2,  -1.4, 4.2,  -1.4, 1.4,  -4.2, 1.4,  -4.2, 4.2,  -1.4,
                   1.4,  -1.4, 1.4,  -1.4, 1.4,  -4.2, 4.2,  -1.4, 1.4,  -1.4};
  return s;
}

// HDL-32E manual, appendix on the firing sequence: -30.67 to 10.67 degrees, 4/3 apart, lower and
// upper half in turns; 32 * 1.152 us and 9.216 us of recharge.
Sensor Hdl32e() {
  Sensor s;
  s.name = "HDL-32E";
  s.model = Model::kHdl32e;
  s.column_us = 46.08;
  s.period_us = 1.152;
  for (int i = 0; i < 16; ++i) {
    s.elevation_deg.push_back((4 * i - 92) / 3.0);
    s.elevation_deg.push_back((4 * i - 28) / 3.0);
  }
  return s;
}

// The order of the lasers in elevation is the same in both halves and in every device.
Sensor Hdl64e() {
  constexpr std::array<int, 32> kRank = {4,  5,  26, 27, 6,  7,  0,  1,  8,  9,  2,
                                         3,  16, 17, 10, 11, 18, 19, 12, 13, 20, 21,
                                         14, 15, 28, 29, 22, 23, 30, 31, 24, 25};
  Sensor s;
  s.name = "HDL-64E";
  s.model = Model::kHdl64e;
  s.column_us = 48;
  s.period_us = 1.2;
  for (const int rank : kRank) s.elevation_deg.push_back(-25.0 / 3 + rank / 3.0);
  for (const int rank : kRank) s.elevation_deg.push_back(-73.0 / 3 + rank / 2.0);
  return s;
}

Sensor Make(Model model) {
  Sensor s = model == Model::kVlp16    ? Vlp16()
             : model == Model::kVlp32c ? Vlp32c()
             : model == Model::kHdl32e ? Hdl32e()
                                       : Hdl64e();
  RankRings(&s);
  return s;
}

[[noreturn]] void Fail(const Sensor& sensor, const std::string& what) {
  throw InputError(sensor.name + " packet: " + what);
}

// The product's byte; an HDL-64E and old firmware have something else there.
void CheckProduct(const Sensor& sensor, std::uint8_t product) {
  struct Known {
    std::uint8_t product;
    Model model;
    const char* name;
  };
  constexpr Known kKnown[] = {{0x21, Model::kHdl32e, "HDL-32E"},
                              {0x22, Model::kVlp16, "VLP-16"},
                              {0x28, Model::kVlp32c, "VLP-32C"}};
  if (sensor.model == Model::kHdl64e) return;
  for (const Known& known : kKnown) {
    if (known.product != product || known.model == sensor.model) continue;
    Fail(sensor, std::string("is of a ") + known.name + "; correct the model in the rig file");
  }
}

struct Block {
  bool lower = false;
  int azimuth = 0;  // [0.01 degrees]
  const std::uint8_t* returns = nullptr;
};

std::array<Block, kBlocks> ReadBlocks(const Sensor& sensor, const std::uint8_t* data) {
  std::array<Block, kBlocks> blocks;
  for (std::size_t i = 0; i < kBlocks; ++i) {
    const std::uint8_t* bytes = data + i * kBlockBytes;
    const std::uint16_t flag = Word(bytes);
    blocks[i].lower = flag == kLower;
    blocks[i].azimuth = Word(bytes + 2);
    blocks[i].returns = bytes + 4;
    const bool in_turns = sensor.model == Model::kHdl64e;
    if (flag != (in_turns && i % 2 == 1 ? kLower : kUpper)) {
      Fail(sensor, "block " + std::to_string(i) + " begins with " + std::to_string(flag) +
                       "; is it data of this model?");
    }
    if (blocks[i].azimuth >= 36000) {
      Fail(sensor, "block " + std::to_string(i) + " has azimuth " +
                       std::to_string(blocks[i].azimuth) + "; expected 0 to 35999");
    }
  }
  return blocks;
}

// The return of the higher reflectivity first, of equal ones the one that came first.
void Merge(const std::uint8_t* bytes, std::size_t count, Return* first, Return* second) {
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint8_t* at = bytes + 3 * i;
    Return other{Word(at), at[2]};
    if (other.distance == 0) continue;
    if (first[i].distance == 0 || other.reflectivity > first[i].reflectivity) {
      std::swap(first[i], other);
    }
    if (second != nullptr && other.distance != 0) second[i] = other;
  }
}

// How far the head turns from one block to a later one [degrees]; nothing where it jumps (a part of
// the turn that is not sent).
double Turn(int from, int to) {
  constexpr double kMost = 5;
  const double turn = (to - from + 36000) % 36000 / 100.0;
  return turn <= kMost ? turn : 0;
}

// Blocks that are one firing (or, VLP-16, two): first ones of them, and how many belong together.
struct Groups {
  std::size_t size = 1;  // blocks
  std::size_t columns = 1;
};

Groups GroupsOf(const Sensor& sensor, const std::array<Block, kBlocks>& blocks, bool* dual) {
  Groups groups;
  if (sensor.model == Model::kVlp16) groups.columns = 2;
  if (sensor.model == Model::kHdl64e) {
    // Its packets do not say so: two returns are two pairs of blocks at one azimuth.
    *dual = blocks[0].azimuth == blocks[2].azimuth && blocks[4].azimuth == blocks[6].azimuth &&
            blocks[0].azimuth != blocks[4].azimuth;
    groups.size = 2;
  }
  if (*dual) groups.size *= 2;
  return groups;
}

}  // namespace

double Sensor::LaserTime_us(int laser) const {
  const int in_half = model == Model::kHdl64e ? laser % 32 : laser;
  const int group = in_half / at_once;
  return group * period_us;
}

const Sensor& SensorOf(VelodyneDevice::Model model) {
  static const std::array<Sensor, 4> sensors = {Make(Model::kVlp16), Make(Model::kVlp32c),
                                                Make(Model::kHdl32e), Make(Model::kHdl64e)};
  for (const Sensor& sensor : sensors) {
    if (sensor.model == model) return sensor;
  }
  throw InputError("Velodyne model " + std::to_string(static_cast<int>(model)) + " is unknown");
}

Packet Decode(const Sensor& sensor, const std::uint8_t* data, std::size_t size) {
  if (size != kDataBytes) {
    Fail(sensor, "has " + std::to_string(size) + " bytes; expected 1206");
  }
  CheckProduct(sensor, data[kProductAt]);
  const auto blocks = ReadBlocks(sensor, data);
  Packet packet;
  packet.stamp_us = LongWord(data + kStampAt) % kHourUs;
  packet.dual = sensor.model != Model::kHdl64e && data[kModeAt] == kDual;
  const Groups groups = GroupsOf(sensor, blocks, &packet.dual);
  const auto lasers = static_cast<std::size_t>(sensor.lasers());
  double turn = 0;
  for (std::size_t first = 0; first < kBlocks; first += groups.size) {
    const std::size_t next = first + groups.size;
    if (next < kBlocks) {
      const double now = Turn(blocks[first].azimuth, blocks[next].azimuth);
      if (now > 0 || turn == 0) turn = now;
    }
    for (std::size_t c = 0; c < groups.columns; ++c) {
      Column column;
      column.step_deg = turn / static_cast<double>(groups.columns);
      column.azimuth_deg =
          std::fmod(blocks[first].azimuth / 100.0 + static_cast<double>(c) * column.step_deg, 360);
      column.time_us = static_cast<double>(packet.columns.size()) * sensor.column_us;
      column.returns.resize(lasers);
      if (packet.dual) column.second_returns.resize(lasers);
      for (std::size_t b = first; b < next; ++b) {
        const std::size_t count = std::min(lasers, kReturns);
        const std::size_t to = blocks[b].lower ? kReturns : 0;
        Merge(blocks[b].returns + 3 * count * c, count, column.returns.data() + to,
              packet.dual ? column.second_returns.data() + to : nullptr);
      }
      packet.columns.push_back(std::move(column));
    }
  }
  return packet;
}

}  // namespace rgbdt::velodyne
