#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "services/drivers/spinning/spinning_sweeps.h"

namespace rgbdt::robosense {

using spinning::Angles;
using spinning::Column;
using spinning::Packet;
using spinning::Return;

inline constexpr std::size_t kPacketBytes = 1248;  ///< of data (MSOP) and of information (DIFOP)
inline constexpr int kInformationPort = 7788;      ///< unless the sensor is told otherwise

/// A sensor, from its user manual and its maker's rs_driver: RS-LiDAR-16, RS-LiDAR-32, RS-Bpearl
/// (two generations), RS-Helios-5515.
struct Sensor {
  std::string name;
  std::size_t channels = 32;
  std::uint8_t head = 0x0a;        ///< the fourth byte of its data packets
  std::uint8_t model = 0;          ///< the 31st
  bool second_generation = false;  ///< as the two bytes behind it say
  bool counts_seconds = false;     ///< its stamp is of seconds since 1970, otherwise a date
  double unit_m = 0.005;           ///< of a distance
  double angle_unit_deg = 0.01;    ///< of the angles in its information packets
  double block_us = 0;             ///< from block to block, of one return
  std::vector<double> slot_us;     ///< when each of a block's 32 beams is fired
  spinning::Lens lens;
};

/// Of a data packet, as far as its head tells; none: it is no known sensor's.
const Sensor* SensorOf(const std::uint8_t* data, std::size_t size);
/// Whether it is an information packet, of whatever sensor.
bool IsInformation(const std::uint8_t* data, std::size_t size);

/// What an information packet says.
struct Information {
  Angles angles;
  bool dual = false;  ///< two returns a beam
};
/// Throws InputError: its angles are none, as of a sensor that was not calibrated.
Information ParseInformation(const Sensor& sensor, const std::uint8_t* data, std::size_t size);

/// A file as rs_driver takes it (angle.csv): a line a channel, elevation and azimuth in degrees.
/// Throws InputError, which begins with `where`.
Angles ParseAngles(const std::string& csv, const std::string& where);

/// Decodes a data packet. `dual` counts for the RS-LiDAR-16 alone: of the others two blocks of one
/// azimuth are two returns of the same beams. Throws InputError saying what is wrong.
Packet Decode(const Sensor& sensor, bool dual, const std::uint8_t* data, std::size_t size);

}  // namespace rgbdt::robosense
