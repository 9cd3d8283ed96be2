#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "services/drivers/ouster/ouster_metadata.h"

namespace rgbdt::ouster {

struct Return {
  std::uint32_t range_mm = 0;  ///< from the turning axis along the beam; 0: nothing returned
  std::uint8_t reflectivity = 0;
};

/// One firing of all beams.
struct Column {
  std::int64_t time_ns = 0;  ///< on the sensor's clock
  int measurement = 0;       ///< its place in the turn, 0 to columns_per_frame - 1
  bool valid = false;
  std::vector<Return> returns;         ///< by row
  std::vector<Return> second_returns;  ///< by row, of Profile::kDual; else empty
};

struct Packet {
  int frame = 0;  ///< number of its turn, 0 to 65535
  std::vector<Column> columns;
};

/// Decodes a lidar packet. Throws InputError saying what is wrong: the size, a column's place.
Packet Decode(const Metadata& metadata, const std::uint8_t* data, std::size_t size);

/// Where a beam of a column begins and which way it goes, in the sensor's frame (x forward, away
/// from the connector, y left, z up); `range` counts from `origin` [m].
struct Beam {
  Eigen::Vector3d origin_m, direction;
};

/// By Ouster's manual, "coordinate frames and XYZ calculation": the encoder's angle is that of the
/// column's place in the turn.
Beam BeamOf(const Metadata& metadata, int row, int measurement);

}  // namespace rgbdt::ouster
