#pragma once

#include <cstdint>

namespace rgbdt::bags {

/// What a record of an MCAP file is: its first byte, as the specification of MCAP has them. Those
/// that reader and writer use.
enum McapOpcode : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kStatistics = 0x0b,
  kSummaryOffset = 0x0e,
  kDataEnd = 0x0f,
};

}  // namespace rgbdt::bags
