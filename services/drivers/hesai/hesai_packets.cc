#include "services/drivers/hesai/hesai_packets.h"

#include <array>
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

// Pandar40P user manual, appendix on absolute time: offsets of channels 1 to 40 [ns].
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
  s.block_us = 55.56;
  s.last_block_us = -28.58;
  for (const int ns :
       {-42220, -28470, -16040, -3620,  -45490, -31740, -47460, -54670, -20620, -33710,
        -40910, -8190,  -20620, -27160, -50730, -8190,  -14740, -36980, -45490, -52700,
        -23890, -31740, -38950, -11470, -18650, -25190, -48760, -6230,  -12770, -35010,
        -21920, -9500,  -43520, -29770, -17350, -4920,  -42220, -28470, -16040, -3620}) {
    s.channel_us.push_back(1e-3 * ns);
  }
  return s;
}

// PandarXT manual, appendix on absolute time.
Sensor PandarXt(std::size_t channels) {
  Sensor s;
  s.name = "PandarXT-" + std::to_string(channels);
  s.channels = channels;
  s.blocks = 8;
  s.head_bytes = 12;
  s.block_head_bytes = 2;
  s.beam_bytes = 4;
  s.mode_at = 10;
  s.date_at = 13;
  s.stamp_at = 19;
  s.tail_bytes = 24;
  s.block_us = 50;
  s.last_block_us = 5.632;
  for (std::size_t i = 0; i < channels; ++i) {
    const std::size_t slot = i * 32 / channels;  // of those that the larger one has
    s.channel_us.push_back(0.368 + 1.512 * static_cast<double>(slot));
  }
  return s;
}

const std::array<Sensor, 3>& Sensors() {
  static const std::array<Sensor, 3> sensors = {Pandar40P(), PandarXt(32), PandarXt(16)};
  return sensors;
}

// Of a date as the sensor keeps it, UTC; absent: it was never set.
std::optional<Utime> UtimeOf(const Sensor& sensor, const std::uint8_t* tail) {
  const std::uint8_t* date = tail + sensor.date_at;
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
  const std::uint8_t* stamp = tail + sensor.stamp_at;
  const auto us = static_cast<Utime>(Word(stamp) + (Word(stamp + 2) << 16));
  return Utime{timegm(&tm)} * kMicrosecondsPerSecond + us;
}

std::size_t ReturnsOf(const Sensor& sensor, std::uint8_t mode) {
  if (mode >= 0x33 && mode <= 0x38) return 1;
  if (mode == 0x39 || mode == 0x3a || mode == 0x3b || mode == 0x3c || mode == 0x3e) return 2;
  throw InputError(sensor.name + " packet: is of return mode " + std::to_string(mode) +
                   "; expected one or two returns");
}

std::vector<Return> ReadBlock(const Sensor& sensor, const std::uint8_t* block, double unit_m) {
  std::vector<Return> returns(sensor.channels);
  const std::uint8_t* beam = block + sensor.block_head_bytes;
  for (Return& back : returns) {
    back = {static_cast<double>(Word(beam)) * unit_m, beam[2]};
    beam += sensor.beam_bytes;
  }
  return returns;
}

}  // namespace

const Sensor& SensorOf(std::size_t channels) {
  for (const Sensor& sensor : Sensors()) {
    if (sensor.channels == channels) return sensor;
  }
  throw InputError("no Hesai of " + std::to_string(channels) +
                   " channels is known; those that are: Pandar40P, PandarXT-32, PandarXT-16");
}

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
                     ": has no channels; expected the angle correction file of a Hesai "
                     "(CSV), or the metadata of an Ouster (JSON)");
  }
  return angles;
}

bool IsPacket(const Sensor& sensor, const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kNumber = 4;  // that may follow
  if (size != sensor.PacketBytes() && size != sensor.PacketBytes() + kNumber) return false;
  if (sensor.head_bytes == 0) return data[0] == 0xff && data[1] == 0xee;
  return data[0] == 0xee && data[1] == 0xff && data[6] == sensor.channels &&
         data[7] == sensor.blocks;
}

Packet Decode(const Sensor& sensor, const std::uint8_t* data, std::size_t size) {
  if (!IsPacket(sensor, data, size)) {
    throw InputError("a datagram of " + std::to_string(size) + " bytes is no packet of a " +
                     sensor.name);
  }
  constexpr double kUnit40P_m = 0.004;
  const double unit_m = sensor.head_bytes == 0 ? kUnit40P_m : 1e-3 * data[9];
  const std::uint8_t* blocks = data + sensor.head_bytes;
  const std::uint8_t* tail = blocks + sensor.blocks * sensor.BlockBytes();
  const std::size_t returns = ReturnsOf(sensor, tail[sensor.mode_at]);
  Packet packet;
  packet.utime = UtimeOf(sensor, tail);
  for (std::size_t block = 0; block < sensor.blocks; block += returns) {
    const std::uint8_t* at = blocks + block * sensor.BlockBytes();
    const std::size_t azimuth = Word(at + sensor.block_head_bytes - 2);
    if (azimuth >= kFullTurn) {
      throw InputError(sensor.name + " packet: has an azimuth of " + std::to_string(azimuth) +
                       " hundredths of a degree");
    }
    Column column;
    column.azimuth_rad = static_cast<double>(azimuth) / 100 * kDegree;
    const std::size_t before_last = (sensor.blocks - block - 1) / returns;
    column.time_us = sensor.last_block_us - sensor.block_us * static_cast<double>(before_last);
    column.returns = ReadBlock(sensor, at, unit_m);
    if (returns == 2) column.second_returns = ReadBlock(sensor, at + sensor.BlockBytes(), unit_m);
    packet.columns.push_back(std::move(column));
  }
  return packet;
}

}  // namespace rgbdt::hesai
