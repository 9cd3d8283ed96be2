#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "calib/model/devices.h"

namespace rgbdt::velodyne {

inline constexpr std::size_t kDataBytes = 1206;     ///< of a data packet
inline constexpr std::size_t kPositionBytes = 554;  ///< of a position packet (GPS, gyro)
inline constexpr std::int64_t kHourUs = 3'600'000'000;

/// A sensor, from its manual: VLP-16 (63-9243), VLP-32C (63-9325), HDL-32E (63-9113), HDL-64E S3
/// (63-HDL64ES3).
///
/// An HDL-64E's lasers differ from device to device by up to a degree in elevation and several in
/// azimuth; its calibration file is not read: these are the nominal elevations (32 lasers from +2
/// degrees down by 1/3, 32 more from -8.83 down by 1/2), all at azimuth 0, and nominal times (0.3
/// ms at most). Good to look at, not to calibrate with.
struct Sensor {
  std::string name;  ///< "VLP-16"
  VelodyneDevice::Model model = VelodyneDevice::Model::kVlp16;
  double unit_m = 0.002;  ///< of a distance
  double column_us = 0;   ///< from one firing of all lasers to the next, recharge included
  double period_us = 0;   ///< from the firing of one laser (or group) to the next
  int at_once = 1;        ///< lasers of a group
  std::vector<double> elevation_deg;  ///< by laser
  std::vector<double> azimuth_deg;    ///< by laser: to be added to the head's, clockwise
  std::vector<int> ring;              ///< by laser: from bottom (0) to top

  int lasers() const { return static_cast<int>(elevation_deg.size()); }
  /// When a laser fires, from its column's begin [us].
  double LaserTime_us(int laser) const;
};
const Sensor& SensorOf(VelodyneDevice::Model model);

struct Return {
  std::uint16_t distance = 0;  ///< [Sensor::unit_m]; 0: nothing returned
  std::uint8_t reflectivity = 0;
};

/// One firing of all lasers.
struct Column {
  double azimuth_deg = 0;  ///< of the head when its first laser fires, clockwise from above, 0..360
  double step_deg = 0;     ///< that the head turns until the next column; 0: unknown
  double time_us = 0;      ///< from the packet's time stamp
  std::vector<Return> returns;  ///< by laser
  /// In dual mode, by laser: the other one, of the lower reflectivity; else empty.
  std::vector<Return> second_returns;
};

struct Packet {
  std::int64_t stamp_us = 0;  ///< of the first firing, since the hour, on the sensor's clock
  bool dual = false;
  std::vector<Column> columns;
};

/// Decodes the 1206 bytes of a data packet. Of two returns of a beam (dual mode) that of the higher
/// reflectivity comes first: a board's edge is hit by beams of which the larger part decides.
/// Throws InputError saying what is wrong: the size, a block's flag or azimuth, or another sensor's
/// data.
Packet Decode(const Sensor& sensor, const std::uint8_t* data, std::size_t size);

}  // namespace rgbdt::velodyne
