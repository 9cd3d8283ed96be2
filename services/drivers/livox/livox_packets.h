#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "calib/model/time.h"

namespace rgbdt::livox {

/// How packets are laid out: "Livox SDK communication protocol" (Avia) and "Livox LiDAR
/// communication protocol - Mid360".
enum class Protocol { kSdk1, kSdk2 };

/// What a packet's stamp counts.
enum class Clock {
  kSinceStart,  ///< [ns] since the sensor was switched on
  kPtp,         ///< [ns] since 1970, of the PTP master
  kUtc,         ///< [ns] since 1970, GPS
};

/// One beam that returned something: its return of the highest reflectivity whose tag is normal.
struct Point {
  Eigen::Vector3f place_m{0, 0, 0};  ///< x forward, y left, z up
  std::uint8_t reflectivity = 0;     ///< 0 to 150: of a matt surface, above: of a reflector
  float time_us = 0;                 ///< from the packet's stamp
};

struct Packet {
  Clock clock = Clock::kSinceStart;
  std::int64_t stamp_ns = 0;  ///< of the first beam
  double duration_us = 0;     ///< from the first beam to the last
  int beams = 0;
  std::vector<Point> points;  ///< of those beams, in order
  int dropped = 0;            ///< beams of whose returns none has a normal tag
};

/// Whether these bytes look like a packet of points; packets of the inertial sensor do not.
bool IsPacket(Protocol protocol, const std::uint8_t* data, std::size_t size);

/// Decodes it. Throws InputError saying what is wrong: the size, a type of points or of stamps that
/// is not known.
Packet Decode(Protocol protocol, const std::uint8_t* data, std::size_t size);

}  // namespace rgbdt::livox
