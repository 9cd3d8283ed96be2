#include "services/messages/signature.h"

#include <algorithm>
#include <cstring>
#include <set>

namespace rgbdt {
namespace {

constexpr char kMark[] = "RGBDTSG1";
constexpr std::size_t kMarkBytes = sizeof(kMark) - 1;
static_assert(kStampBytes + sizeof(Signature::tag) + kMarkBytes == kSignatureBytes);

void AppendBigEndian(std::uint64_t value, Bytes* to) {
  for (int shift = 56; shift >= 0; shift -= 8) {
    to->push_back(static_cast<std::uint8_t>(value >> shift));
  }
}

std::uint64_t BigEndian(const std::uint8_t* from) {
  std::uint64_t value = 0;
  for (int i = 0; i < 8; ++i) value = value << 8 | from[i];
  return value;
}

}  // namespace

bool IsSignedChannel(const std::string& channel) {
  static const std::set<std::string> channels = {
      "CALIBRATION",     "CORNER_SELECTION", "DETECTION", "LEFT_OUT_VIEWS",
      "MOUNT_CHECK",     "REPORT",           "RIG",       "SESSION_EVENT",
      "SESSION_COMMAND", "SESSION_REQUEST",  "STATUS",    "WAVE_PROGRESS"};
  return channels.count(channel) != 0;
}

void AppendSignature(const Signature& signature, Bytes* message) {
  AppendBigEndian(signature.sender, message);
  AppendBigEndian(static_cast<std::uint64_t>(signature.number), message);
  AppendBigEndian(static_cast<std::uint64_t>(signature.utime), message);
  message->insert(message->end(), std::begin(signature.tag), std::end(signature.tag));
  message->insert(message->end(), kMark, kMark + kMarkBytes);
}

std::optional<Signature> SignatureOf(const std::uint8_t* data, std::size_t size) {
  if (size < kSignatureBytes) return std::nullopt;
  const std::uint8_t* at = data + size - kSignatureBytes;
  if (std::memcmp(data + size - kMarkBytes, kMark, kMarkBytes) != 0) return std::nullopt;
  Signature signature;
  signature.sender = BigEndian(at);
  signature.number = static_cast<std::int64_t>(BigEndian(at + 8));
  signature.utime = static_cast<Utime>(BigEndian(at + 16));
  std::copy_n(at + kStampBytes, sizeof(signature.tag), signature.tag);
  return signature;
}

std::size_t SizeWithoutSignature(const std::string& channel, const std::uint8_t* data,
                                 std::size_t size) {
  const bool is_signed = IsSignedChannel(channel) && SignatureOf(data, size).has_value();
  return is_signed ? size - kSignatureBytes : size;
}

}  // namespace rgbdt
