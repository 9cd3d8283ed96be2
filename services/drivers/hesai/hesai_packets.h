#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "calib/model/time.h"
#include "services/drivers/hesai/hesai_sensors.h"
#include "services/drivers/spinning/spinning_sweeps.h"

namespace rgbdt::hesai {

using spinning::Angles;
using spinning::Column;
using spinning::Packet;
using spinning::Return;

/// A device's "angle correction file", which the sensor hands out (CSV: channel, elevation,
/// azimuth, in degrees). Throws InputError, which begins with `where`: no such file, a channel
/// missing or twice.
Angles ParseAngles(const std::string& csv, const std::string& where);

/// Of a point cloud packet, as far as its head tells; none: it is no known sensor's.
const Sensor* SensorOf(const std::uint8_t* data, std::size_t size);

/// Decodes a point cloud packet of this sensor. Throws InputError saying what is wrong: no such
/// packet, an azimuth, a return mode of three returns.
Packet Decode(const Sensor& sensor, const std::uint8_t* data, std::size_t size);

}  // namespace rgbdt::hesai
