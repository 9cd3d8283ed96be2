#include "services/bus/internal/repair_message.h"

#include <algorithm>

#include "services/messages/limits.h"

namespace rgbdt {
namespace {

constexpr std::uint8_t kBeatMark = 'B', kRequestMark = 'R';
constexpr std::size_t kMaxHostBytes = 64;
constexpr std::size_t kBeatBytes = 32;  // without mark and host

void Put(std::uint64_t value, int bytes, Bytes* to) {
  for (int i = 0; i < bytes; ++i) to->push_back(static_cast<std::uint8_t>(value >> 8 * i));
}

class Reader {
 public:
  Reader(const std::uint8_t* data, std::size_t size) : data_(data), left_(size) {}

  std::size_t left() const { return left_; }
  bool Has(std::size_t bytes) const { return left_ >= bytes; }
  /// Has() them.
  template <typename Number>
  Number Take() {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < sizeof(Number); ++i) {
      value |= static_cast<std::uint64_t>(data_[i]) << 8 * i;
    }
    data_ += sizeof(Number);
    left_ -= sizeof(Number);
    return static_cast<Number>(value);
  }
  std::string Rest(std::size_t most) const {
    return {reinterpret_cast<const char*>(data_), std::min(left_, most)};
  }

 private:
  const std::uint8_t* data_;
  std::size_t left_;
};

RepairMessage DecodeBeat(Reader reader) {
  if (!reader.Has(kBeatBytes)) return {};
  Beat beat;
  beat.id = reader.Take<std::uint64_t>();
  beat.oldest = reader.Take<std::uint32_t>();
  beat.next = reader.Take<std::uint32_t>();
  beat.datagrams = reader.Take<std::uint64_t>();
  beat.host_utime = reader.Take<std::int64_t>();
  // A stranger's number: what it is off by is computed, too.
  if (beat.host_utime < 0 || beat.host_utime > kMaxInteger) return {};
  beat.host = reader.Rest(kMaxHostBytes);
  return beat;
}

RepairMessage DecodeRequest(Reader reader) {
  if (!reader.Has(sizeof(std::uint64_t))) return {};
  RepairRequest request;
  request.id = reader.Take<std::uint64_t>();
  while (reader.left() > 0) {
    if (!reader.Has(6)) return {};
    MissingParts parts;
    parts.seq = reader.Take<std::uint32_t>();
    const auto count = reader.Take<std::uint16_t>();
    if (!reader.Has(2 * std::size_t{count})) return {};
    for (int i = 0; i < count; ++i) parts.fragments.push_back(reader.Take<std::uint16_t>());
    request.parts.push_back(std::move(parts));
  }
  return request;
}

}  // namespace

Bytes Encode(const Beat& beat) {
  Bytes bytes{kBeatMark};
  Put(beat.id, 8, &bytes);
  Put(beat.oldest, 4, &bytes);
  Put(beat.next, 4, &bytes);
  Put(beat.datagrams, 8, &bytes);
  Put(static_cast<std::uint64_t>(beat.host_utime), 8, &bytes);
  const std::size_t length = std::min(beat.host.size(), kMaxHostBytes);
  bytes.insert(bytes.end(), beat.host.begin(),
               beat.host.begin() + static_cast<std::ptrdiff_t>(length));
  return bytes;
}

Bytes Encode(const RepairRequest& request) {
  Bytes bytes{kRequestMark};
  Put(request.id, 8, &bytes);
  for (const MissingParts& parts : request.parts) {
    Put(parts.seq, 4, &bytes);
    Put(parts.fragments.size(), 2, &bytes);
    for (const std::uint16_t fragment : parts.fragments) Put(fragment, 2, &bytes);
  }
  return bytes;
}

RepairMessage DecodeRepairMessage(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return {};
  const Reader reader(data + 1, size - 1);
  switch (data[0]) {
    case kBeatMark:
      return DecodeBeat(reader);
    case kRequestMark:
      return DecodeRequest(reader);
    case kRepairMark:
      return Repair{Bytes(data + 1, data + size)};
    default:
      return {};
  }
}

}  // namespace rgbdt
