#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calib/model/rigid3.h"

namespace rgbdt::ouster {

/// How a packet lays out its beams.
enum class Profile {
  kLegacy,        ///< "LEGACY": 12 bytes a beam
  kSingle,        ///< "RNG19_RFL8_SIG16_NIR16": 12 bytes
  kDual,          ///< "RNG19_RFL8_SIG16_NIR16_DUAL": 16 bytes, two returns
  kLowBandwidth,  ///< "RNG15_RFL8_NIR8": 4 bytes
};

/// What an Ouster sensor says of itself: the JSON that it hands out (`GET /api/v1/sensor/metadata`,
/// or before firmware 3.0 `get_sensor_info` and the like in one), as every recording tool of Ouster
/// keeps it beside the packets.
struct Metadata {
  std::string model;  ///< "OS-1-64"
  Profile profile = Profile::kLegacy;
  int columns_per_frame = 0;  ///< of a whole turn
  int columns_per_packet = 0;
  int rows = 0;                  ///< beams of a column, the topmost first
  std::vector<int> pixel_shift;  ///< by row: columns that it is to be moved by, so that they align
  std::vector<double> altitude_rad, azimuth_rad;  ///< by row
  Eigen::Vector2d beam_origin_m{0, 0};  ///< of all beams, from the turning axis: outwards, up
  Rigid3 sensor_from_lidar;             ///< of the turning head's axes

  std::size_t BeamBytes() const;
  std::size_t ColumnBytes() const;
  std::size_t PacketBytes() const;
};

/// Reads it, of firmware 2.0 on. Throws InputError, which begins with `where`: no JSON, something
/// missing, sizes that no sensor has, another profile.
Metadata ParseMetadata(const std::string& text, const std::string& where);

}  // namespace rgbdt::ouster
