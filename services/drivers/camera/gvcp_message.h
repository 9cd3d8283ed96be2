#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace rgbdt {

/// GigE Vision's control protocol (GVCP, over UDP): what is needed to find cameras. All numbers on
/// the wire are big-endian; a header of 8 bytes: type, flags, command, length of what follows, id.
inline constexpr int kGvcpPort = 3956;
inline constexpr std::uint32_t kGvcpControlPrivilege = 0x0a00;  ///< register; 0: nobody controls it

/// A camera's answer to the discovery: its first 248 bytes of registers.
struct GvcpDevice {
  std::uint32_t address = 0, mask = 0, gateway = 0;  ///< see network_interfaces.h
  std::string mac;                                   ///< "00:11:1c:00:12:34"
  std::string vendor, model, serial, user_name;
};

/// `id`, 1 to 65535, comes back with the answer.
std::vector<std::uint8_t> MakeGvcpDiscovery(std::uint16_t id);
std::vector<std::uint8_t> MakeGvcpReadRegister(std::uint16_t id, std::uint32_t register_address);

/// Absent where the bytes are no whole answer to that id.
std::optional<GvcpDevice> ParseGvcpDiscovery(const std::vector<std::uint8_t>& bytes,
                                             std::uint16_t id);

/// What a camera says to a register's read.
struct GvcpRegister {
  int status = 0;           ///< 0: well; else GigE Vision's error, 0x8006 is "access denied"
  std::uint32_t value = 0;  ///< where the status is 0
};
std::optional<GvcpRegister> ParseGvcpRegister(const std::vector<std::uint8_t>& bytes,
                                              std::uint16_t id);

}  // namespace rgbdt
