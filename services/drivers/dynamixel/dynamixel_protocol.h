#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

/// Packets of the Dynamixel Protocol 2.0, as published in the ROBOTIS e-Manual ("DYNAMIXEL
/// Protocol 2.0"): FF FF FD 00, id, length, instruction, parameters, CRC-16. Bytes <-> structs.
namespace rgbdt::dynamixel {

using Bytes = std::vector<std::uint8_t>;

/// CRC-16 with the polynomial 0x8005, begun at 0, most significant bit first.
std::uint16_t Crc16(const std::uint8_t* data, std::size_t size);

/// Instructions to the servo `id` (0 to 252), ready to be sent.
Bytes EncodePing(int id);
Bytes EncodeRead(int id, int address, int size);
Bytes EncodeWrite(int id, int address, const Bytes& value);

/// A servo's answer.
struct Status {
  int id = 0;
  std::uint8_t error = 0;  ///< as it came; ErrorNumber() and alert() take it apart
  Bytes parameters;
  std::size_t wire_size = 0;  ///< bytes of the packet as it travelled

  int ErrorNumber() const { return error & 0x7F; }
  /// The servo has found a fault in itself; its Hardware Error Status says which.
  bool alert() const { return (error & 0x80) != 0; }
};

/// Why a servo refused an instruction, for a person: "the value is beyond the servo's limit".
std::string ErrorInWords(int error_number);

/// What a servo's Hardware Error Status means, for a person: "overheating, overload".
std::string HardwareErrorInWords(int hardware_error_status);

/// Finds status packets in a stream that may bring them in pieces, with rubbish around them and
/// with echoes of the instructions. Packets with a wrong CRC are counted and left out.
class StatusDecoder {
 public:
  /// A status packet that says it is longer is none: nothing longer was asked for.
  static constexpr std::size_t kMaxLength = 256;

  void Add(const Bytes& bytes) { buffer_.insert(buffer_.end(), bytes.begin(), bytes.end()); }
  /// The next whole packet; nothing as long as there is none.
  std::optional<Status> Next();
  /// Forgets what has come, so that it answers no later instruction.
  void Clear() { buffer_.clear(); }

  std::int64_t bad_checksums() const { return bad_checksums_; }

 private:
  void SkipRubbish();

  Bytes buffer_;
  std::int64_t bad_checksums_ = 0;
};

/// Little-endian, two's complement, as in the servo's control table; `size` 1, 2 or 4 bytes.
Bytes ToBytes(std::int64_t value, int size);
std::int64_t SignedFrom(const Bytes& bytes);
std::int64_t UnsignedFrom(const Bytes& bytes);

}  // namespace rgbdt::dynamixel
