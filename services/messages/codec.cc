#include "services/messages/codec.h"

#include <array>
#include <string_view>

#include "calib/model/errors.h"
#include "services/messages/check.h"
#include "services/messages/internal/codec_types.h"
#include "services/messages/internal/layout.h"

namespace rgbdt {
namespace {

template <typename Wire>
bool IsA(const std::uint8_t* data, std::size_t size) {
  std::uint64_t fingerprint = 0;
  for (std::size_t i = 0; i < 8 && i < size; ++i) fingerprint = fingerprint << 8 | data[i];
  return size >= 8 && fingerprint == static_cast<std::uint64_t>(Wire::getHash());
}

template <typename Wire>
Message DecodeAs(const std::string& channel, std::string_view layout, const std::uint8_t* data,
                 std::size_t size) {
  if (!IsA<Wire>(data, size)) {
    throw InputError(std::string("the message is no ") + Wire::getTypeName() +
                     ": another type or version on channel " + channel);
  }
  CheckLayout(layout, data, size);
  Wire wire;
  if (wire.decode(data, 0, static_cast<int>(size)) != static_cast<int>(size)) {
    throw InputError(std::string("the message does not decode as ") + Wire::getTypeName());
  }
  Check(wire);
  return FromWire(std::move(wire));
}

// Logs from before observation_v3_t hold the observation_v2_t that it begins with, or the
// observation_t that this begins with.
Message DecodeObservation(const std::string& channel, std::string_view layout,
                          const std::uint8_t* data, std::size_t size) {
  if (IsA<observation_t>(data, size)) {
    return DecodeAs<observation_t>(channel, "observation_t", data, size);
  }
  if (IsA<observation_v2_t>(data, size)) {
    return DecodeAs<observation_v2_t>(channel, "observation_v2_t", data, size);
  }
  return DecodeAs<observation_v3_t>(channel, layout, data, size);
}

// Logs from before rgbdt_cloud_v2_t hold the rgbdt_cloud_t that it begins with.
Message DecodeRgbdtCloud(const std::string& channel, std::string_view layout,
                         const std::uint8_t* data, std::size_t size) {
  if (IsA<rgbdt_cloud_t>(data, size)) {
    return DecodeAs<rgbdt_cloud_t>(channel, "rgbdt_cloud_t", data, size);
  }
  return DecodeAs<rgbdt_cloud_v2_t>(channel, layout, data, size);
}

struct Kind {
  std::string_view channel;
  Message (*decode)(const std::string& channel, std::string_view layout, const std::uint8_t* data,
                    std::size_t size);
  std::string_view layout;  // the .lcm file once more: layout.h; a test holds them together
};

constexpr Kind kImage = {"_IMAGE", DecodeAs<image_t>, "2q s 2q d 4i b 8d b #size size*b"};

constexpr std::string_view kRgbdtCloud =
    "rgbdt_cloud_t b #num_calibrations num_calibrations*q b q 7d #num_sigmas num_sigmas*f";

constexpr std::array<Kind, 16> kKinds = {{
    {"LINE_SCAN", DecodeAs<line_scan_t>, "2q 3d #num_beams num_beams*f num_beams*f"},
    {"ENCODER", DecodeAs<encoder_t>, "4q"},
    {"CLOUD", DecodeAs<cloud_t>,
     "3q b 3i #num_points num_points*f num_points*f num_points*f num_points*f num_points*i "
     "num_points*h #num_origins num_origins*f num_origins*f num_origins*f #num_misses num_misses*i "
     "num_misses*f num_misses*f num_misses*f b 2i"},
    {"CORNER_SELECTION", DecodeAs<corner_selection_t>, "2q s q 8d"},
    {"OBSERVATION", DecodeObservation,
     "observation_v2_t board_scatter_t #num_candidate_scatters "
     "num_candidate_scatters*board_scatter_t"},
    {"CALIBRATION", DecodeAs<calibration_t>, "2q 3s b s 7d b 36d"},
    {"RGBDT_CLOUD", DecodeRgbdtCloud, kRgbdtCloud},
    {"RGBDT_SWEEP", DecodeAs<rgbdt_cloud_v2_t>, kRgbdtCloud},
    {"POSE", DecodeAs<pose_t>, "2q s 7d"},
    {"RIG", DecodeAs<rig_t>, "2q 2s"},
    {"SESSION_COMMAND", DecodeAs<session_command_t>, "3q b s q b #num_picked num_picked*s"},
    {"SESSION_EVENT", DecodeAs<session_event_t>, "3q s b s q d"},
    {"SESSION_REQUEST", DecodeAs<session_request_t>, "2q 2b"},
    {"SIGHTING", DecodeAs<sighting_t>,
     "2q s b s #num_corners num_corners*2d #num_outline num_outline*2d 3d"},
    {"STATUS", DecodeAs<status_t>, "2q s b 2s #num_counters num_counters*s num_counters*q"},
    {"REPORT", DecodeAs<report_t>, "2q s"},
}};

const Kind& KindOf(const std::string& channel) {
  for (const Kind& kind : kKinds) {
    if (kind.channel == channel) return kind;
  }
  const std::size_t suffix = kImage.channel.size();
  if (channel.size() > suffix &&
      channel.compare(channel.size() - suffix, suffix, kImage.channel) == 0) {
    return kImage;
  }
  throw InputError("no message type belongs to channel " + channel);
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
        Check(wire);
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
  const Kind& kind = KindOf(channel);
  CheckSize(size);
  Message message = kind.decode(channel, kind.layout, data, size);
  const std::string own = ChannelOf(message);
  if (own != channel) throw InputError("the message belongs on channel " + own);
  return message;
}

}  // namespace rgbdt
