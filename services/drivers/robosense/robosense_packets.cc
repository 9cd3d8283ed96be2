#include "services/drivers/robosense/robosense_packets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <sstream>

#include "calib/model/errors.h"

namespace rgbdt::robosense {
namespace {

constexpr double kDegree = M_PI / 180;
constexpr int kFullTurn = 36000;  // [0.01 degrees]
// A data packet: a head, 12 blocks of flag, azimuth [0.01 degrees] and 32 returns, a tail. All
// numbers have their most significant byte first.
constexpr std::size_t kHeadBytes = 42, kBlocks = 12, kBlockBytes = 100, kSlots = 32;
constexpr std::size_t kStampAt = 20, kModelAt = 30;
constexpr std::array<std::uint8_t, 8> kInformationHead = {0xa5, 0xff, 0x00, 0x5a,
                                                          0x11, 0x11, 0x55, 0x55};

int Word(const std::uint8_t* bytes) { return bytes[0] << 8 | bytes[1]; }

// Beams one after the other, `period_us` apart.
std::vector<double> Even(double period_us) {
  std::vector<double> us(kSlots);
  for (std::size_t i = 0; i < us.size(); ++i) us[i] = period_us * static_cast<double>(i);
  return us;
}

// All 16 beams twice a block.
Sensor Rs16() {
  Sensor s;
  s.name = "RS-LiDAR-16";
  s.channels = 16;
  s.model = 1;
  s.angle_unit_deg = 1e-4;
  s.block_us = 111;
  s.slot_us = Even(2.8);
  for (std::size_t i = 16; i < kSlots; ++i) s.slot_us[i] = s.slot_us[i - 16] + 55.5;
  s.lens.outward_m = 0.03825;
  return s;
}

// The second 16 beams between the first.
Sensor Rs32() {
  Sensor s;
  s.name = "RS-LiDAR-32";
  s.model = 2;
  s.angle_unit_deg = 1e-3;
  s.block_us = 55.52;
  s.slot_us = Even(2.88);
  s.slot_us[15] = 44.64;
  for (std::size_t i = 16; i < kSlots; ++i) s.slot_us[i] = s.slot_us[i - 16] + 1.44;
  s.lens.outward_m = 0.03997;
  return s;
}

Sensor Bpearl() {
  Sensor s;
  s.name = "RS-Bpearl";
  s.model = 3;
  s.block_us = 55.52;
  s.slot_us = Even(2.56);
  for (std::size_t i = 8; i < 16; ++i) s.slot_us[i] = s.slot_us[i - 8] + 25.68;
  for (std::size_t i = 16; i < kSlots; ++i) s.slot_us[i] = s.slot_us[i - 16] + 1.28;
  s.lens = {0.01473, 0.09427};
  return s;
}

Sensor Bpearl4() {
  Sensor s;
  s.name = "RS-Bpearl (2nd generation)";
  s.model = 3;
  s.second_generation = true;
  s.counts_seconds = true;
  s.unit_m = 0.0025;
  s.block_us = 55.56;
  s.slot_us = Even(1.668);
  s.lens = {0.01619, 0.09571};
  return s;
}

Sensor Helios() {
  Sensor s;
  s.name = "RS-Helios-5515";
  s.head = 0x5a;
  s.model = 6;
  s.counts_seconds = true;
  s.unit_m = 0.0025;
  s.block_us = 55.56;
  s.slot_us = Even(1.73);
  s.lens.outward_m = 0.03498;
  return s;
}

const std::array<Sensor, 5>& Sensors() {
  static const std::array<Sensor, 5> sensors = {Rs16(), Rs32(), Bpearl(), Bpearl4(), Helios()};
  return sensors;
}

bool IsOf(const Sensor& sensor, const std::uint8_t* data) {
  constexpr std::array<std::uint8_t, 4> kRest = {0x5a, 0xa5, 0x50, 0xa0};
  if (data[0] != 0x55 || data[1] != 0xaa || data[2] != 0x05 || data[3] != sensor.head) return false;
  if (sensor.head == 0x0a && !std::equal(kRest.begin(), kRest.end(), data + 4)) return false;
  const bool second = data[kModelAt + 1] == 3 && data[kModelAt + 2] == 4;
  return data[kModelAt] == sensor.model &&
         (sensor.model != 3 || second == sensor.second_generation);
}

// Absent: the sensor's clock was never set.
std::optional<Utime> UtimeOf(const Sensor& sensor, const std::uint8_t* stamp) {
  constexpr Utime k2010 = 1'262'304'000;
  Utime second = 0, us = 0;
  if (sensor.counts_seconds) {
    for (int i = 0; i < 6; ++i) second = second << 8 | stamp[i];
    us = Utime{Word(stamp + 6)} << 16 | Word(stamp + 8);
  } else {
    std::tm tm{};
    tm.tm_year = 100 + stamp[0];
    tm.tm_mon = stamp[1] - 1;
    tm.tm_mday = stamp[2];
    tm.tm_hour = stamp[3];
    tm.tm_min = stamp[4];
    tm.tm_sec = stamp[5];
    second = timegm(&tm);
    us = Utime{1000} * Word(stamp + 6) + Word(stamp + 8);
  }
  constexpr Utime k2200 = 7'258'118'400;
  if (second < k2010 || second >= k2200) return std::nullopt;
  return second * kMicrosecondsPerSecond + us;
}

std::array<int, kBlocks> AzimuthsOf(const Sensor& sensor, const std::uint8_t* data) {
  std::array<int, kBlocks> azimuths{};
  for (std::size_t block = 0; block < kBlocks; ++block) {
    const std::uint8_t* at = data + kHeadBytes + block * kBlockBytes;
    azimuths[block] = Word(at + 2);
    if (Word(at) != 0xffee || azimuths[block] >= kFullTurn) {
      throw InputError(sensor.name + " packet: block " + std::to_string(block + 1) +
                       " has the flag " + std::to_string(Word(at)) + " and an azimuth of " +
                       std::to_string(azimuths[block]) + " hundredths of a degree");
    }
  }
  return azimuths;
}

// Of each block, from the azimuths [0.01 degrees]: how far the head turns until the next one, and
// how many blocks' time there is between, more where a sector is left out.
struct Steps {
  std::array<double, kBlocks> turn{}, passed{};
};

Steps StepsOf(const std::array<int, kBlocks>& azimuths) {
  Steps steps;
  double least = kFullTurn, sum = 0;
  int count = 0;
  for (std::size_t b = 0; b + 1 < kBlocks; ++b) {
    const double gap = std::remainder(azimuths[b + 1] - azimuths[b], kFullTurn);
    if (gap > 0) least = std::min(least, gap);
    steps.turn[b] = gap;
  }
  constexpr double kSector = 1.5;  // as often as the smallest step: more was left out
  for (std::size_t b = 0; b + 1 < kBlocks; ++b) {
    double& turn = steps.turn[b];
    steps.passed[b] = turn <= 0 ? 0 : turn > kSector * least ? std::round(turn / least) : 1;
    if (turn > kSector * least) turn = least;
    if (turn <= 0) continue;
    sum += turn;
    ++count;
  }
  const double mean = count > 0 ? sum / count : 0;
  steps.turn[kBlocks - 1] = mean;
  // Of the first of two blocks of one azimuth it is the second one's.
  for (std::size_t b = kBlocks - 1; b-- > 0;) {
    if (steps.turn[b] <= 0) steps.turn[b] = steps.turn[b + 1];
  }
  return steps;
}

// The beams of one firing, from slot `first` on.
std::vector<Return> ReadFiring(const Sensor& sensor, const std::uint8_t* block, std::size_t first,
                               double turn, double block_us) {
  std::vector<Return> returns(sensor.channels);
  for (std::size_t i = 0; i < sensor.channels; ++i) {
    const std::uint8_t* beam = block + 4 + 3 * (first + i);
    const double after_us = sensor.slot_us[i];  // of the first firing; the second is as long
    returns[i].range_m = Word(beam) * sensor.unit_m;
    returns[i].reflectivity = beam[2];
    returns[i].after_us = static_cast<float>(after_us);
    returns[i].turned_rad = static_cast<float>(turn / 100 * kDegree * after_us / block_us);
  }
  return returns;
}

double SignedAngle(const std::uint8_t* bytes, double unit_deg) {
  if (bytes[0] == 0xff) throw InputError("a RoboSense's information packet has no angles");
  return (bytes[0] == 0 ? 1 : -1) * Word(bytes + 1) * unit_deg;
}

void Add(double elevation_deg, double azimuth_deg, Angles* angles) {
  if (!(std::abs(elevation_deg) <= 90) || !(std::abs(azimuth_deg) <= 180)) {
    throw InputError("an elevation of " + std::to_string(elevation_deg) + " and an azimuth of " +
                     std::to_string(azimuth_deg) + " degrees are none");
  }
  angles->elevation_rad.push_back(elevation_deg * kDegree);
  angles->azimuth_rad.push_back(azimuth_deg * kDegree);
}

}  // namespace

const Sensor* SensorOf(const std::uint8_t* data, std::size_t size) {
  if (size != kPacketBytes) return nullptr;
  for (const Sensor& sensor : Sensors()) {
    if (IsOf(sensor, data)) return &sensor;
  }
  return nullptr;
}

bool IsInformation(const std::uint8_t* data, std::size_t size) {
  return size == kPacketBytes && std::equal(kInformationHead.begin(), kInformationHead.end(), data);
}

Information ParseInformation(const Sensor& sensor, const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kReturnsAt = 300, kElevationsAt = 468, kAzimuthsAt = 564, k16At = 1165;
  if (!IsInformation(data, size)) throw InputError("no information packet of a RoboSense");
  Information information;
  information.dual = data[kReturnsAt] == 0;
  for (std::size_t i = 0; i < sensor.channels; ++i) {
    if (sensor.channels == 16) {  // magnitudes of three bytes; the lower eight channels come first
      const std::uint8_t* at = data + k16At + 3 * i;
      const double magnitude = (at[0] << 16 | Word(at + 1)) * sensor.angle_unit_deg;
      Add(i < 8 ? -magnitude : magnitude, 0, &information.angles);
    } else {
      Add(SignedAngle(data + kElevationsAt + 3 * i, sensor.angle_unit_deg),
          SignedAngle(data + kAzimuthsAt + 3 * i, sensor.angle_unit_deg), &information.angles);
    }
  }
  return information;
}

Angles ParseAngles(const std::string& csv, const std::string& where) {
  constexpr std::size_t kMost = 256;
  Angles angles;
  std::istringstream lines(csv);
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    std::istringstream fields(line);
    double elevation = 0, azimuth = 0;
    char comma = 0;
    if (!(fields >> elevation)) continue;  // a heading
    const bool has_azimuth = static_cast<bool>(fields >> comma);
    if ((has_azimuth && !(comma == ',' && fields >> azimuth)) || fields >> comma ||
        angles.elevation_rad.size() >= kMost) {
      throw InputError(where + ":" + std::to_string(number) +
                       ": expected elevation and azimuth [degrees], a line a channel");
    }
    try {
      Add(elevation, azimuth, &angles);
    } catch (const InputError& error) {
      throw InputError(where + ":" + std::to_string(number) + ": " + error.what());
    }
  }
  return angles;
}

Packet Decode(const Sensor& sensor, bool dual, const std::uint8_t* data, std::size_t size) {
  if (size != kPacketBytes || !IsOf(sensor, data)) {
    throw InputError("a datagram of " + std::to_string(size) + " bytes is no packet of a " +
                     sensor.name);
  }
  const std::array<int, kBlocks> azimuths = AzimuthsOf(sensor, data);
  const Steps steps = StepsOf(azimuths);
  const bool twice = sensor.channels < kSlots;  // a block has two firings, or two returns of one
  const double block_us = sensor.block_us * (twice && dual ? 0.5 : 1);
  Packet packet;
  packet.utime = UtimeOf(sensor, data + kStampAt);
  double time_us = 0;
  for (std::size_t b = 0; b < kBlocks; time_us += block_us * steps.passed[b], ++b) {
    const std::uint8_t* block = data + kHeadBytes + b * kBlockBytes;
    const auto read = [&](std::size_t first) {
      return ReadFiring(sensor, block, first, steps.turn[b], block_us);
    };
    const bool again = !twice && b > 0 && azimuths[b] == azimuths[b - 1] &&
                       packet.columns.back().second_returns.empty();
    if (again) {
      packet.columns.back().second_returns = read(0);
      continue;
    }
    Column column;
    column.azimuth_rad = azimuths[b] / 100.0 * kDegree;
    column.time_us = time_us;
    column.returns = read(0);
    if (twice && dual) column.second_returns = read(sensor.channels);
    packet.columns.push_back(std::move(column));
    if (!twice || dual) continue;
    const double later_us = sensor.slot_us[sensor.channels];
    Column second;
    second.azimuth_rad = (azimuths[b] + steps.turn[b] * later_us / block_us) / 100.0 * kDegree;
    second.time_us = time_us + later_us;
    second.returns = read(sensor.channels);
    packet.columns.push_back(std::move(second));
  }
  return packet;
}

}  // namespace rgbdt::robosense
