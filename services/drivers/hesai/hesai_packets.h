#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "calib/model/time.h"
#include "services/drivers/hesai/hesai_sensors.h"

namespace rgbdt::hesai {

/// Where each channel looks, of one device: its "angle correction file" (CSV: channel, elevation,
/// azimuth, in degrees), which the sensor hands out.
struct Angles {
  std::vector<double> elevation_rad;  ///< by channel
  std::vector<double> azimuth_rad;    ///< by channel: to be added to the block's, clockwise
};

/// Throws InputError, which begins with `where`: no such file, a channel missing or twice.
Angles ParseAngles(const std::string& csv, const std::string& where);

struct Return {
  double range_m = 0;  ///< 0: nothing returned
  std::uint8_t reflectivity = 0;
  float after_us = 0;  ///< when it was fired, from its column's time; NaN: it was not
};

/// One firing of all channels.
struct Column {
  double azimuth_rad = 0;       ///< of the block, clockwise from above, 0 at the sensor's front
  double time_us = 0;           ///< from the packet's stamp; a return's time comes on top
  std::vector<Return> returns;  ///< by channel
  std::vector<Return> second_returns;  ///< of two returns; else empty
};

struct Packet {
  std::optional<Utime> utime;  ///< the packet's stamp; absent: its clock was never set
  std::vector<Column> columns;
};

/// Of a point cloud packet, as far as its head tells; none: it is no known sensor's.
const Sensor* SensorOf(const std::uint8_t* data, std::size_t size);

/// Decodes a point cloud packet of this sensor. Throws InputError saying what is wrong: no such
/// packet, an azimuth, a return mode of three returns.
Packet Decode(const Sensor& sensor, const std::uint8_t* data, std::size_t size);

}  // namespace rgbdt::hesai
