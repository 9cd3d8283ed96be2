#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "calib/model/time.h"

namespace rgbdt::hesai {

/// How a sensor packs its blocks, from its manual: Pandar40P, PandarXT-16 and -32.
struct Sensor {
  std::string name;
  std::size_t channels = 0, blocks = 0;
  std::size_t head_bytes = 0;        ///< before the blocks
  std::size_t block_head_bytes = 0;  ///< before a block's beams; its azimuth is the last two
  std::size_t beam_bytes = 0;        ///< distance (2), reflectivity, and what follows
  std::size_t mode_at = 0, date_at = 0, stamp_at = 0;  ///< in the tail
  int first_year = 1900;                               ///< that the date counts from
  std::size_t tail_bytes = 0;                          ///< at least
  double block_us = 0;                                 ///< from block to block, of one return
  double last_block_us = 0;        ///< of the last block, from the packet's stamp
  std::vector<double> channel_us;  ///< when each fires, from its block's time

  std::size_t BlockBytes() const { return block_head_bytes + channels * beam_bytes; }
  std::size_t PacketBytes() const { return head_bytes + blocks * BlockBytes() + tail_bytes; }
};

/// The sensor of so many channels. Throws InputError where there is none.
const Sensor& SensorOf(std::size_t channels);

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
};

/// One firing of all channels.
struct Column {
  double azimuth_rad = 0;       ///< of the block, clockwise from above, 0 at the sensor's front
  double time_us = 0;           ///< from the packet's stamp; a channel's time comes on top
  std::vector<Return> returns;  ///< by channel
  std::vector<Return> second_returns;  ///< of two returns; else empty
};

struct Packet {
  std::optional<Utime> utime;  ///< the packet's stamp; absent: its clock was never set
  std::vector<Column> columns;
};

/// Whether these bytes look like the sensor's.
bool IsPacket(const Sensor& sensor, const std::uint8_t* data, std::size_t size);

/// Decodes a point cloud packet. Throws InputError saying what is wrong: no such packet, an
/// azimuth, a return mode of three returns.
Packet Decode(const Sensor& sensor, const std::uint8_t* data, std::size_t size);

}  // namespace rgbdt::hesai
