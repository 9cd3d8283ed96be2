#include "services/drivers/dynamixel/dynamixel_protocol.h"

#include <algorithm>
#include <array>

namespace rgbdt::dynamixel {
namespace {

constexpr std::array<std::uint8_t, 4> kHeader = {0xFF, 0xFF, 0xFD, 0x00};
constexpr std::size_t kBodyAt = 7;      // after header, id and length
constexpr std::size_t kCrcSize = 2;     // counted by the length, as are instruction and parameters
constexpr std::size_t kMinLength = 3;   // a ping: instruction and CRC
constexpr std::uint8_t kStatus = 0x55;  // the instruction of every answer

enum Instruction : std::uint8_t { kPing = 1, kRead = 2, kWrite = 3 };

using CrcTable = std::array<std::uint16_t, 256>;

CrcTable MakeCrcTable() {
  CrcTable table{};
  for (unsigned i = 0; i < table.size(); ++i) {
    unsigned crc = i << 8;
    for (int bit = 0; bit < 8; ++bit) crc = (crc << 1) ^ ((crc & 0x8000) != 0 ? 0x8005 : 0);
    table[i] = static_cast<std::uint16_t>(crc);
  }
  return table;
}

std::uint8_t Low(unsigned value) { return value & 0xFF; }
std::uint8_t High(unsigned value) { return (value >> 8) & 0xFF; }

bool EndsLikeAHeader(const Bytes& bytes, std::size_t from) {
  const std::size_t size = bytes.size();
  return size >= from + 3 && bytes[size - 3] == 0xFF && bytes[size - 2] == 0xFF &&
         bytes[size - 1] == 0xFD;
}

// What would look like a header inside a packet gets one more FD.
void AppendStuffed(const Bytes& body, Bytes* packet) {
  const std::size_t from = packet->size();
  for (const std::uint8_t byte : body) {
    packet->push_back(byte);
    if (EndsLikeAHeader(*packet, from)) packet->push_back(0xFD);
  }
}

Bytes Unstuffed(const Bytes& stuffed) {
  Bytes body;
  for (std::size_t i = 0; i < stuffed.size(); ++i) {
    body.push_back(stuffed[i]);
    if (EndsLikeAHeader(body, 0) && i + 1 < stuffed.size() && stuffed[i + 1] == 0xFD) ++i;
  }
  return body;
}

// The length and the CRC are those of the packet as it travels, stuffing included.
Bytes Encode(int id, Instruction instruction, const Bytes& parameters) {
  Bytes body = {instruction};
  body.insert(body.end(), parameters.begin(), parameters.end());
  Bytes packet(kHeader.begin(), kHeader.end());
  packet.insert(packet.end(), {Low(id), 0, 0});
  AppendStuffed(body, &packet);
  const std::size_t length = packet.size() - kBodyAt + kCrcSize;
  packet[5] = Low(length);
  packet[6] = High(length);
  const std::uint16_t crc = Crc16(packet.data(), packet.size());
  packet.insert(packet.end(), {Low(crc), High(crc)});
  return packet;
}

std::string Joined(const std::vector<std::string>& words) {
  std::string all;
  for (const std::string& word : words) all += (all.empty() ? "" : ", ") + word;
  return all;
}

}  // namespace

std::uint16_t Crc16(const std::uint8_t* data, std::size_t size) {
  static const CrcTable table = MakeCrcTable();
  unsigned crc = 0;
  for (std::size_t i = 0; i < size; ++i) crc = (crc << 8) ^ table[High(crc) ^ data[i]];
  return static_cast<std::uint16_t>(crc);
}

Bytes EncodePing(int id) { return Encode(id, kPing, {}); }

Bytes EncodeRead(int id, int address, int size) {
  return Encode(id, kRead, {Low(address), High(address), Low(size), High(size)});
}

Bytes EncodeWrite(int id, int address, const Bytes& value) {
  Bytes parameters = {Low(address), High(address)};
  parameters.insert(parameters.end(), value.begin(), value.end());
  return Encode(id, kWrite, parameters);
}

// Leaves the buffer empty, or beginning with a header or with what may become one.
void StatusDecoder::SkipRubbish() {
  auto begin = buffer_.begin();
  for (; begin != buffer_.end(); ++begin) {
    const auto size = std::min<std::ptrdiff_t>(kHeader.size(), buffer_.end() - begin);
    if (std::equal(begin, begin + size, kHeader.begin())) break;
  }
  buffer_.erase(buffer_.begin(), begin);
}

std::optional<Status> StatusDecoder::Next() {
  for (SkipRubbish(); buffer_.size() >= kBodyAt; SkipRubbish()) {
    const std::size_t length = buffer_[5] + 256u * buffer_[6];
    if (length < kMinLength || length > kMaxLength) {
      buffer_.erase(buffer_.begin());  // no header after all: a packet may begin within
      continue;
    }
    const std::size_t size = kBodyAt + length;
    if (buffer_.size() < size) return std::nullopt;
    const unsigned crc = buffer_[size - 2] + 256u * buffer_[size - 1];
    if (crc != Crc16(buffer_.data(), size - kCrcSize)) {
      ++bad_checksums_;
      buffer_.erase(buffer_.begin());
      continue;
    }
    const auto begin = buffer_.begin();
    const Bytes body = Unstuffed(Bytes(begin + kBodyAt, begin + (size - kCrcSize)));
    const int id = buffer_[4];
    buffer_.erase(begin, begin + size);
    if (body[0] != kStatus || body.size() < 2) continue;  // an echo of what was sent
    return Status{id, body[1], Bytes(body.begin() + 2, body.end()), size};
  }
  return std::nullopt;
}

std::string ErrorInWords(int error_number) {
  switch (error_number) {
    case 0:
      return "no error";
    case 1:
      return "it could not do it (result fail)";
    case 2:
      return "it does not know the instruction";
    case 3:
      return "the instruction reached it damaged (CRC)";
    case 4:
      return "the value is out of range (data range)";
    case 5:
      return "the value has too few bytes (data length)";
    case 6:
      return "the value is beyond the servo's own limit (data limit)";
    case 7:
      return "the entry cannot be read or written now (access)";
    default:
      return "error " + std::to_string(error_number);
  }
}

std::string HardwareErrorInWords(int hardware_error_status) {
  constexpr std::array<const char*, 6> kBits = {
      "input voltage out of limits",          "motor hall sensor", "overheating", "motor encoder",
      "electrical shock or too little power", "overload"};
  std::vector<std::string> words;
  for (std::size_t bit = 0; bit < 8; ++bit) {
    if ((hardware_error_status >> bit & 1) == 0) continue;
    words.push_back(bit < kBits.size() ? kBits[bit] : "bit " + std::to_string(bit));
  }
  return words.empty() ? "none named" : Joined(words);
}

Bytes ToBytes(std::int64_t value, int size) {
  Bytes bytes;
  for (int i = 0; i < size; ++i) {
    bytes.push_back(static_cast<std::uint64_t>(value) >> (8 * i) & 0xFF);
  }
  return bytes;
}

std::int64_t UnsignedFrom(const Bytes& bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) value |= std::uint64_t{bytes[i]} << (8 * i);
  return static_cast<std::int64_t>(value);
}

std::int64_t SignedFrom(const Bytes& bytes) {
  const std::int64_t value = UnsignedFrom(bytes);
  const std::int64_t range = std::int64_t{1} << (8 * bytes.size());
  return value >= range / 2 ? value - range : value;
}

}  // namespace rgbdt::dynamixel
