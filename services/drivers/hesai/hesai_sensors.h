#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace rgbdt::hesai {

/// What a beam fires at, where it depends on where the head is: a channel fires in a slot, and the
/// slots' times change from state to state of the azimuth (0 to 3).
struct Slots {
  static constexpr std::size_t kOuter = 4;  ///< slots of channels that fire in every other state
  /// By state and slot: the outer ones, then those of channels that fire in each state [us].
  std::array<std::vector<double>, 4> us;
  /// By channel a hexadecimal digit: an outer slot in states 0 and 2 (0 to 3) or in states 1 and 3
  /// (4 to 7), or another slot (8 to f).
  const char* of_channels = nullptr;
  std::vector<char>
      late;           ///< those that fire in the second half of a column of standard resolution
  double near_m = 0;  ///< nearer returns are of a firing of their own, where there is one:
  struct Near {
    std::size_t state, channel;
    double us;
  };
  std::vector<Near> near;
};

/// How a sensor packs its blocks and when its channels fire, from its maker's manual, or as its
/// maker's published correction files have it.
struct Sensor {
  std::string name;
  std::size_t channels = 0, blocks = 0;
  int version = 0;  ///< of the protocol, major << 8 | minor; 0: packets do not say
  int first_kind = 0, last_kind = 255;  ///< of the head's fifth byte, which tells sensors apart
  std::size_t head_bytes = 0;           ///< before the blocks
  std::size_t block_head_bytes = 2;     ///< before a block's beams; its azimuth is the last two
  std::size_t beam_bytes = 0;           ///< distance (2), reflectivity, and what follows
  std::uint8_t beam_flags = 0;  ///< of the head's flags, those that each add a byte to a beam
  bool checked = false;  ///< a sum (4) behind the blocks, and functional safety (17) by a flag
  std::size_t mode_at = 0, date_at = 0, stamp_at = 0;  ///< in the tail
  std::size_t turn_at = 0;     ///< likewise: the blocks' states of the azimuth, or whose turn it is
  int first_year = 1900;       ///< that the date counts from
  std::size_t tail_bytes = 0;  ///< at least
  std::size_t more_bytes = 0;  ///< that may follow: a number, sums, a signature
  double block_us = 0;         ///< from block to block, of one return
  double last_block_us = 0;    ///< of the last block, from the packet's stamp
  bool from_first = false;     ///< it is the first block's
  unsigned no_return = 0;      ///< distances up to this say why nothing returned
  std::vector<double> channel_us;  ///< when each fires, from its block's time; or:
  const Slots* slots = nullptr;    ///< 128 channels, of which in high resolution not all fire
  /// 128 channels of which the first and the second 32 take turns: when each fires in either.
  std::array<std::vector<double>, 2> loop_us;
};

/// All that are known.
const std::vector<Sensor>& Sensors();

/// When the channels of a block fire, from the block's time [us]; NaN: this one does not.
struct Firing {
  std::vector<double> us;       ///< by channel
  std::vector<double> near_us;  ///< of returns nearer than `near_m`; empty: the same
  double near_m = 0;
};

/// `turn`: of a sensor with slots the state of the azimuth, with loops which of them.
Firing FiringOf(const Sensor& sensor, std::size_t turn, bool high_resolution);

}  // namespace rgbdt::hesai
