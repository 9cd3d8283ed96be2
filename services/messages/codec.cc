#include "services/messages/codec.h"

#include <map>
#include <string_view>
#include <utility>

#include "calib/model/errors.h"
#include "services/messages/check.h"
#include "services/messages/image_channel.h"
#include "services/messages/internal/codec_types.h"
#include "services/messages/internal/layout.h"
#include "services/messages/signature.h"

namespace rgbdt {
namespace {

// Whoever sends names the channel, by any bytes.
std::string Shown(const std::string& channel) {
  constexpr std::size_t kMaxChannelBytes = 63;  // LCM's
  return Printable(channel, kMaxChannelBytes);
}

template <typename Wire>
bool IsA(const std::uint8_t* data, std::size_t size) {
  std::uint64_t fingerprint = 0;
  for (std::size_t i = 0; i < 8 && i < size; ++i) fingerprint = fingerprint << 8 | data[i];
  return size >= 8 && fingerprint == static_cast<std::uint64_t>(Wire::getHash());
}

// What every type's Check leaves to its caller.
template <typename Wire>
void CheckWhole(const Wire& wire) {
  CheckSeq(wire.seq);
  Check(wire);
}

template <typename Wire>
Wire WireFrom(const std::uint8_t* data, std::size_t size) {
  Layouts::OfMessages().Check(Wire::getTypeName(), data, size);
  Wire wire;
  if (wire.decode(data, 0, static_cast<int>(size)) != static_cast<int>(size)) {
    throw InputError(std::string("the message does not decode as ") + Wire::getTypeName());
  }
  CheckWhole(wire);
  return wire;
}

template <typename Wire>
Message DecodeAs(const std::string& channel, const std::uint8_t* data, std::size_t size) {
  if (!IsA<Wire>(data, size)) {
    throw InputError(std::string("the message is no ") + Wire::getTypeName() +
                     ": another type or version on channel " + Shown(channel));
  }
  return FromWire(WireFrom<Wire>(data, size));
}

using Decoder = Message (*)(const std::string& channel, const std::uint8_t* data, std::size_t size);
using Decoders = std::map<std::string, Decoder, std::less<>>;

template <typename Struct>
using WireType = decltype(ToWire(std::declval<const Struct&>()));

template <typename... Struct>
Decoders DecodersOf(const std::variant<Struct...>* /*messages*/) {
  return {{ChannelOf(Struct()), DecodeAs<WireType<Struct>>}...};
}

// By channel. Of an image's the end, as of an image whose camera has no name.
const Decoders& AllDecoders() {
  static const Decoders decoders = [] {
    Decoders all = DecodersOf(static_cast<const Message*>(nullptr));
    RgbdtCloud sweep;
    sweep.whole_sweep = true;
    all[ChannelOf(sweep)] = DecodeAs<rgbdt_cloud_t>;
    return all;
  }();
  return decoders;
}

Decoder DecoderOf(const std::string& channel) {
  const Decoders& decoders = AllDecoders();
  static const std::string image = ImageChannel("");
  const auto found = decoders.find(IsImageChannel(channel) ? image : channel);
  if (found == decoders.end() || channel == image) {
    throw InputError("no message type belongs to channel " + Shown(channel));
  }
  return found->second;
}

void CheckSize(std::size_t size) {
  if (size <= kMaxMessageBytes) return;
  throw InputError("the message has " + std::to_string(size) + " bytes; the bus carries " +
                   std::to_string(kMaxMessageBytes) +
                   ": send a cloud in chunks, an image as raw Bayer, JPEG or PNG");
}

}  // namespace

Bytes Encode(const Message& message) {
  return std::visit(
      [](const auto& m) {
        const auto wire = ToWire(m);
        CheckWhole(wire);
        const auto size = static_cast<std::size_t>(wire.getEncodedSize());
        CheckSize(size);
        Bytes bytes(size);
        if (wire.encode(bytes.data(), 0, static_cast<int>(size)) != static_cast<int>(size)) {
          throw InputError(std::string("the message does not encode as ") + wire.getTypeName());
        }
        return bytes;
      },
      message);
}

Message Decode(const std::string& channel, const std::uint8_t* data, std::size_t size) {
  const Decoder decode = DecoderOf(channel);
  CheckSize(size);
  Message message = decode(channel, data, SizeWithoutSignature(channel, data, size));
  const std::string own = ChannelOf(message);
  if (own != channel) throw InputError("the message belongs on channel " + own);
  return message;
}

Bytes ImageFileOf(const std::uint8_t* data, std::size_t size) {
  image_t wire = WireFrom<image_t>(data, size);
  const bool is_file = wire.pixel_format == image_t::JPEG || wire.pixel_format == image_t::PNG;
  return is_file ? std::move(wire.data) : Bytes();
}

}  // namespace rgbdt
