#include "services/drivers/hesai/hesai_packets.h"

#include <algorithm>
#include <bitset>
#include <cmath>
#include <ctime>
#include <sstream>

#include "calib/model/errors.h"

namespace rgbdt::hesai {
namespace {

constexpr double kDegree = M_PI / 180;
constexpr int kFullTurn = 36000;  // [0.01 degrees]

std::size_t Word(const std::uint8_t* bytes) {
  return static_cast<std::size_t>(bytes[0] | bytes[1] << 8);
}

// Of a date as the sensor keeps it, UTC, or, where its year is 0, of seconds since 1970, most
// significant byte first; absent: it was never set.
std::optional<Utime> SecondOf(const Sensor& sensor, const std::uint8_t* date) {
  constexpr Utime k2010 = 1'262'304'000;
  if (sensor.version != 0 && date[0] == 0) {
    const Utime second =
        Utime{date[2]} << 24 | Utime{date[3]} << 16 | Utime{date[4]} << 8 | Utime{date[5]};
    if (second >= k2010) return second;
  }
  const bool is_date = date[1] >= 1 && date[1] <= 12 && date[2] >= 1 && date[2] <= 31 &&
                       date[3] < 24 && date[4] < 60 && date[5] <= 60;
  constexpr int kFirst = 2010;  // a clock that was not set counts from its maker's begin
  if (!is_date || sensor.first_year + date[0] < kFirst) return std::nullopt;
  std::tm tm{};
  tm.tm_year = sensor.first_year - 1900 + date[0];
  tm.tm_mon = date[1] - 1;
  tm.tm_mday = date[2];
  tm.tm_hour = date[3];
  tm.tm_min = date[4];
  tm.tm_sec = date[5];
  return Utime{timegm(&tm)};
}

std::optional<Utime> UtimeOf(const Sensor& sensor, const std::uint8_t* tail) {
  const std::optional<Utime> second = SecondOf(sensor, tail + sensor.date_at);
  if (!second) return std::nullopt;
  const std::uint8_t* stamp = tail + sensor.stamp_at;
  const auto us = static_cast<Utime>(Word(stamp) + (Word(stamp + 2) << 16));
  return *second * kMicrosecondsPerSecond + us;
}

std::size_t ReturnsOf(const Sensor& sensor, std::uint8_t mode) {
  if (mode >= 0x33 && mode <= 0x38) return 1;
  if (mode == 0x39 || mode == 0x3a || mode == 0x3b || mode == 0x3c || mode == 0x3e) return 2;
  throw InputError(sensor.name + " packet: is of return mode " + std::to_string(mode) +
                   "; expected one or two returns");
}

// Where a packet's parts lie, by its head.
struct Parts {
  std::size_t beam_bytes = 0, block_bytes = 0, tail_at = 0, size = 0;
};

Parts PartsOf(const Sensor& sensor, const std::uint8_t* data) {
  constexpr std::size_t kSumBytes = 4, kSafetyBytes = 17;
  constexpr unsigned kHasSafety = 0x04;
  const unsigned flags = sensor.version == 0 ? 0 : data[sensor.head_bytes - 1];
  Parts parts;
  parts.beam_bytes = sensor.beam_bytes + std::bitset<8>(flags & sensor.beam_flags).count();
  parts.block_bytes = sensor.block_head_bytes + sensor.channels * parts.beam_bytes;
  parts.tail_at = sensor.head_bytes + sensor.blocks * parts.block_bytes;
  if (sensor.checked) parts.tail_at += kSumBytes + ((flags & kHasSafety) != 0 ? kSafetyBytes : 0);
  parts.size = parts.tail_at + sensor.tail_bytes;
  return parts;
}

bool IsOf(const Sensor& sensor, const std::uint8_t* data, std::size_t size) {
  if (size < sensor.head_bytes + 2) return false;
  if (sensor.head_bytes == 0 && (data[0] != 0xff || data[1] != 0xee)) return false;
  if (sensor.head_bytes != 0) {
    const std::uint8_t* counts = data + (sensor.version == 0 ? 2 : 6);
    if (data[0] != 0xee || data[1] != 0xff || counts[0] != sensor.channels ||
        counts[1] != sensor.blocks) {
      return false;
    }
  }
  if (sensor.version != 0 && ((data[2] << 8 | data[3]) != sensor.version ||
                              data[4] < sensor.first_kind || data[4] > sensor.last_kind)) {
    return false;
  }
  const std::size_t least = PartsOf(sensor, data).size;
  return size >= least && size <= least + sensor.more_bytes;
}

// Which of its firing times a block has.
std::size_t TurnOf(const Sensor& sensor, const std::uint8_t* tail, std::size_t block,
                   std::size_t returns) {
  if (sensor.slots != nullptr) {  // two bits a block, from the highest ones on
    return Word(tail + sensor.turn_at) >> (14 - 2 * block) & 3;
  }
  // An odd flag: the first column is of the first loop, the next one of the other.
  return sensor.turn_at == 0 ? 0 : (tail[sensor.turn_at] + block / returns + 1) % 2;
}

double UnitOf(const Sensor& sensor, const std::uint8_t* data) {
  constexpr double kUnit40P_m = 0.004;
  if (sensor.head_bytes == 0) return kUnit40P_m;
  return 1e-3 * data[sensor.version == 0 ? 5 : 9];
}

std::vector<Return> ReadBlock(const Sensor& sensor, const std::uint8_t* beam,
                              std::size_t beam_bytes, double unit_m, const Firing& firing) {
  std::vector<Return> returns(sensor.channels);
  for (std::size_t channel = 0; channel < sensor.channels; ++channel, beam += beam_bytes) {
    const std::size_t distance = Word(beam);
    Return& back = returns[channel];
    back.range_m = distance <= sensor.no_return ? 0 : static_cast<double>(distance) * unit_m;
    back.reflectivity = beam[2];
    const bool near = back.range_m > 0 && back.range_m < firing.near_m;
    back.after_us = static_cast<float>((near ? firing.near_us : firing.us)[channel]);
  }
  return returns;
}

// Which some sensors hand out behind the angles: SHA-256, in hexadecimal digits.
bool IsSum(const std::string& line) {
  const std::size_t digits = line.find_first_not_of("0123456789abcdefABCDEF");
  return std::min(digits, line.size()) == 64;
}

}  // namespace

Angles ParseAngles(const std::string& csv, const std::string& where) {
  constexpr std::size_t kMost = 256;
  Angles angles;
  std::vector<bool> have;
  std::istringstream lines(csv);
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    std::istringstream fields(line);
    std::size_t channel = 0;
    char comma = 0;
    double elevation = 0, azimuth = 0;
    if (!(fields >> channel)) continue;  // a heading
    if (IsSum(line)) continue;
    const bool good = fields >> comma >> elevation >> comma >> azimuth && channel >= 1 &&
                      channel <= kMost && std::abs(elevation) <= 90 && std::abs(azimuth) <= 180;
    if (good && have.size() < channel) {
      have.resize(channel);
      angles.elevation_rad.resize(channel);
      angles.azimuth_rad.resize(channel);
    }
    if (!good || have[channel - 1]) {
      throw InputError(where + ":" + std::to_string(number) +
                       ": expected channel, elevation and azimuth [degrees], each channel once");
    }
    have[channel - 1] = true;
    angles.elevation_rad[channel - 1] = elevation * kDegree;
    angles.azimuth_rad[channel - 1] = azimuth * kDegree;
  }
  for (std::size_t i = 0; i < have.size(); ++i) {
    if (!have[i]) throw InputError(where + ": has no channel " + std::to_string(i + 1));
  }
  if (have.empty()) {
    throw InputError(where +
                     ": has no channels; expected the angles of a Hesai or RoboSense "
                     "(CSV), or the metadata of an Ouster (JSON)");
  }
  return angles;
}

const Sensor* SensorOf(const std::uint8_t* data, std::size_t size) {
  for (const Sensor& sensor : Sensors()) {
    if (IsOf(sensor, data, size)) return &sensor;
  }
  return nullptr;
}

Packet Decode(const Sensor& sensor, const std::uint8_t* data, std::size_t size) {
  if (!IsOf(sensor, data, size)) {
    throw InputError("a datagram of " + std::to_string(size) + " bytes is no packet of a " +
                     sensor.name);
  }
  const Parts parts = PartsOf(sensor, data);
  const std::uint8_t* tail = data + parts.tail_at;
  const double unit_m = UnitOf(sensor, data);
  const std::size_t returns = ReturnsOf(sensor, tail[sensor.mode_at]);
  const bool high_resolution = sensor.slots != nullptr && tail[sensor.turn_at + 2] == 0;
  const double block_us = sensor.block_us * (high_resolution ? 0.5 : 1);
  Packet packet;
  packet.utime = UtimeOf(sensor, tail);
  packet.column_us = block_us;
  for (std::size_t block = 0; block < sensor.blocks; block += returns) {
    const std::uint8_t* at = data + sensor.head_bytes + block * parts.block_bytes;
    const std::uint8_t* beams = at + sensor.block_head_bytes;
    const std::size_t azimuth = Word(beams - 2);
    if (azimuth >= kFullTurn) {
      throw InputError(sensor.name + " packet: has an azimuth of " + std::to_string(azimuth) +
                       " hundredths of a degree");
    }
    const Firing firing = FiringOf(sensor, TurnOf(sensor, tail, block, returns), high_resolution);
    Column column;
    column.azimuth_rad = static_cast<double>(azimuth) / 100 * kDegree;
    const auto passed = static_cast<double>(
        sensor.from_first ? block / returns : (sensor.blocks - block - 1) / returns);
    column.time_us = sensor.last_block_us + block_us * (sensor.from_first ? passed : -passed);
    column.returns = ReadBlock(sensor, beams, parts.beam_bytes, unit_m, firing);
    if (returns == 2) {
      column.second_returns =
          ReadBlock(sensor, beams + parts.block_bytes, parts.beam_bytes, unit_m, firing);
    }
    packet.columns.push_back(std::move(column));
  }
  return packet;
}

}  // namespace rgbdt::hesai
