#include "services/drivers/camera/gvcp_message.h"

#include <cstdio>

namespace rgbdt {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::size_t kHeaderBytes = 8;
constexpr std::size_t kDiscoveryBytes = 248;
constexpr std::uint8_t kCommandKey = 0x42;
constexpr std::uint8_t kAnswerWanted = 0x01;
// The camera may broadcast its answer: from another subnet it could not reach us otherwise.
constexpr std::uint8_t kBroadcastAnswer = 0x10;
constexpr std::uint16_t kDiscovery = 0x0002, kDiscoveryAnswer = 0x0003;
constexpr std::uint16_t kReadRegister = 0x0080, kReadRegisterAnswer = 0x0081;

// Where a discovery's answer holds what (GigE Vision's bootstrap registers).
constexpr std::size_t kMac = 0x0a, kAddress = 0x24, kMask = 0x34, kGateway = 0x44;
constexpr std::size_t kVendor = 0x48, kModel = 0x68, kSerial = 0xd8, kUserName = 0xe8;

std::uint32_t Number(const Bytes& bytes, std::size_t at, std::size_t size) {
  std::uint32_t number = 0;
  for (std::size_t i = at; i < at + size; ++i) number = number << 8 | bytes[i];
  return number;
}

// Up to the first zero; what a terminal could take for a command becomes '?'.
std::string Text(const Bytes& bytes, std::size_t at, std::size_t size) {
  std::string text;
  for (std::size_t i = at; i < at + size && bytes[i] != 0; ++i) {
    text += bytes[i] >= ' ' && bytes[i] <= '~' ? static_cast<char>(bytes[i]) : '?';
  }
  return text;
}

std::string MacText(const Bytes& bytes, std::size_t at) {
  char text[18];
  std::snprintf(text, sizeof text, "%02x:%02x:%02x:%02x:%02x:%02x", bytes[at], bytes[at + 1],
                bytes[at + 2], bytes[at + 3], bytes[at + 4], bytes[at + 5]);
  return text;
}

Bytes Header(std::uint8_t flags, std::uint16_t command, std::uint16_t length, std::uint16_t id) {
  const auto high = [](std::uint16_t number) { return static_cast<std::uint8_t>(number >> 8); };
  const auto low = [](std::uint16_t number) { return static_cast<std::uint8_t>(number & 0xff); };
  return {kCommandKey,  flags,       high(command), low(command),
          high(length), low(length), high(id),      low(id)};
}

bool Answers(const Bytes& bytes, std::uint16_t command, std::uint16_t id) {
  return bytes.size() >= kHeaderBytes && Number(bytes, 2, 2) == command &&
         Number(bytes, 6, 2) == id && kHeaderBytes + Number(bytes, 4, 2) <= bytes.size();
}

}  // namespace

Bytes MakeGvcpDiscovery(std::uint16_t id) {
  return Header(kAnswerWanted | kBroadcastAnswer, kDiscovery, 0, id);
}

Bytes MakeGvcpReadRegister(std::uint16_t id, std::uint32_t register_address) {
  Bytes bytes = Header(kAnswerWanted, kReadRegister, 4, id);
  for (int shift = 24; shift >= 0; shift -= 8) {
    bytes.push_back(static_cast<std::uint8_t>(register_address >> shift & 0xff));
  }
  return bytes;
}

std::optional<GvcpDevice> ParseGvcpDiscovery(const Bytes& bytes, std::uint16_t id) {
  if (!Answers(bytes, kDiscoveryAnswer, id) || Number(bytes, 0, 2) != 0 ||
      Number(bytes, 4, 2) < kDiscoveryBytes) {
    return {};
  }
  const Bytes data(bytes.begin() + kHeaderBytes, bytes.end());
  GvcpDevice device;
  device.mac = MacText(data, kMac);
  device.address = Number(data, kAddress, 4);
  device.mask = Number(data, kMask, 4);
  device.gateway = Number(data, kGateway, 4);
  device.vendor = Text(data, kVendor, 32);
  device.model = Text(data, kModel, 32);
  device.serial = Text(data, kSerial, 16);
  device.user_name = Text(data, kUserName, 16);
  if (device.serial.empty()) device.serial = device.mac;  // as Aravis names such a camera
  return device;
}

std::optional<GvcpRegister> ParseGvcpRegister(const Bytes& bytes, std::uint16_t id) {
  if (!Answers(bytes, kReadRegisterAnswer, id)) return {};
  GvcpRegister read;
  read.status = static_cast<int>(Number(bytes, 0, 2));
  if (read.status != 0) return read;
  if (Number(bytes, 4, 2) < 4) return {};
  read.value = Number(bytes, kHeaderBytes, 4);
  return read;
}

}  // namespace rgbdt
