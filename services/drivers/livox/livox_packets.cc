#include "services/drivers/livox/livox_packets.h"

#include <cmath>
#include <ctime>
#include <optional>
#include <string>

#include "calib/model/errors.h"
#include "calib/model/livox.h"

namespace rgbdt::livox {
namespace {

constexpr double kHundredth = M_PI / 18000;  // of a degree
constexpr std::size_t kHead1 = 18, kHead2 = 36;
constexpr std::size_t kMostBeams = 1000;  // of a datagram
constexpr double kBeam1_us = 1e6 / 240'000;

std::uint64_t Number(const std::uint8_t* bytes, std::size_t size) {
  std::uint64_t value = 0;
  for (std::size_t i = size; i-- > 0;) value = value << 8 | bytes[i];
  return value;
}
double Signed(const std::uint8_t* bytes, std::size_t size) {
  const std::uint64_t value = Number(bytes, size);
  return size == 4 ? static_cast<std::int32_t>(value) : static_cast<std::int16_t>(value);
}

// How a beam's returns lie in its bytes.
enum class Layout { kCartesian, kSpherical, kSharedAngles };
struct Type {
  Layout layout = Layout::kCartesian;
  std::size_t number_bytes = 4;  // of a coordinate
  double unit_m = 1e-3;
  std::size_t returns = 1;

  std::size_t ReturnBytes() const {  // with reflectivity and tag
    switch (layout) {
      case Layout::kCartesian:
        return 3 * number_bytes + 2;
      case Layout::kSpherical:
        return 10;
      default:
        return 6;
    }
  }
  std::size_t BeamBytes() const {
    return (layout == Layout::kSharedAngles ? 4 : 0) + returns * ReturnBytes();
  }
};

std::optional<Type> TypeOf(Protocol protocol, int number) {
  if (protocol == Protocol::kSdk2) {
    switch (number) {
      case 1:
        return Type{};
      case 2:
        return Type{Layout::kCartesian, 2, 0.01};
      case 3:
        return Type{Layout::kSpherical};
      default:
        return std::nullopt;
    }
  }
  switch (number) {
    case 2:
      return Type{};
    case 3:
      return Type{Layout::kSpherical};
    case 4:
      return Type{Layout::kCartesian, 4, 1e-3, 2};
    case 5:
      return Type{Layout::kSharedAngles, 4, 1e-3, 2};
    case 7:
      return Type{Layout::kCartesian, 4, 1e-3, 3};
    case 8:
      return Type{Layout::kSharedAngles, 4, 1e-3, 3};
    default:
      return std::nullopt;
  }
}

int TypeNumber(Protocol protocol, const std::uint8_t* data) {
  return data[protocol == Protocol::kSdk1 ? 9 : 10];
}
std::size_t HeadBytes(Protocol protocol) { return protocol == Protocol::kSdk1 ? kHead1 : kHead2; }

struct Return {
  Eigen::Vector3f place_m{0, 0, 0};
  std::uint8_t reflectivity = 0, tag = 0;
};

Eigen::Vector3f FromAngles(double depth_m, double theta, double phi) {
  return (depth_m * Eigen::Vector3d(std::sin(theta) * std::cos(phi),
                                    std::sin(theta) * std::sin(phi), std::cos(theta)))
      .cast<float>();
}

// `angles`: where theta and phi lie.
Return ReadReturn(const Type& type, const std::uint8_t* at, const std::uint8_t* angles) {
  Return back;
  back.reflectivity = at[type.ReturnBytes() - 2];
  back.tag = at[type.ReturnBytes() - 1];
  if (type.layout == Layout::kCartesian) {
    for (std::size_t i = 0; i < 3; ++i) {
      back.place_m[static_cast<Eigen::Index>(i)] =
          static_cast<float>(type.unit_m * Signed(at + i * type.number_bytes, type.number_bytes));
    }
    return back;
  }
  const double depth_m = type.unit_m * static_cast<double>(Number(at, 4));
  back.place_m = FromAngles(depth_m, kHundredth * static_cast<double>(Number(angles, 2)),
                            kHundredth * static_cast<double>(Number(angles + 2, 2)));
  return back;
}

// Nothing: no return, or none that is normal; then `noise` tells which.
std::optional<Return> BestOf(const Type& type, const std::uint8_t* beam, bool* noise) {
  std::optional<Return> best;
  const bool shared = type.layout == Layout::kSharedAngles;
  for (std::size_t i = 0; i < type.returns; ++i) {
    const std::uint8_t* at = beam + (shared ? 4 : 0) + i * type.ReturnBytes();
    const Return back = ReadReturn(type, at, shared ? beam : at + 4);
    if (back.place_m.isZero(0)) continue;
    if (!IsNormalLivoxPoint(back.tag)) {
      *noise = true;
    } else if (!best || back.reflectivity > best->reflectivity) {
      best = back;
    }
  }
  return best;
}

// Of SDK1's "UTC format": year, month, day, hour, and microseconds of the hour.
std::int64_t UtcOf(const std::uint8_t* stamp) {
  std::tm tm{};
  tm.tm_year = 100 + stamp[0];
  tm.tm_mon = stamp[1] - 1;
  tm.tm_mday = stamp[2];
  tm.tm_hour = stamp[3];
  const bool good =
      stamp[1] >= 1 && stamp[1] <= 12 && stamp[2] >= 1 && stamp[2] <= 31 && stamp[3] < 24;
  if (!good) throw InputError("Livox packet: its date is none");
  return std::int64_t{timegm(&tm)} * 1'000'000'000 +
         static_cast<std::int64_t>(Number(stamp + 4, 4)) * 1000;
}

void ReadStamp(Protocol protocol, const std::uint8_t* data, Packet* packet) {
  const int type = data[protocol == Protocol::kSdk1 ? 8 : 11];
  const std::uint8_t* stamp = data + HeadBytes(protocol) - 8;
  const auto ns = static_cast<std::int64_t>(Number(stamp, 8));
  constexpr std::int64_t kMost = 4'000'000'000'000'000'000;  // 2096
  packet->clock = type == 0 || (protocol == Protocol::kSdk1 && type == 4) ? Clock::kSinceStart
                  : type == 1                                             ? Clock::kPtp
                                                                          : Clock::kUtc;
  const bool utc_format = protocol == Protocol::kSdk1 && type == 3;
  const bool known = type <= 1 || utc_format || type == (protocol == Protocol::kSdk1 ? 4 : 2);
  if (!known) {
    throw InputError("Livox packet: its stamp is of type " + std::to_string(type) +
                     ", which is not known");
  }
  packet->stamp_ns = utc_format ? UtcOf(stamp) : ns;
  if (packet->stamp_ns < 0 || packet->stamp_ns > kMost) {
    throw InputError("Livox packet: its stamp is " + std::to_string(packet->stamp_ns) +
                     " ns; expected 0 or more, before 2096");
  }
}

}  // namespace

bool IsPacket(Protocol protocol, const std::uint8_t* data, std::size_t size) {
  if (size <= HeadBytes(protocol)) return false;
  const auto type = TypeOf(protocol, TypeNumber(protocol, data));
  const std::size_t body = size - HeadBytes(protocol);
  constexpr std::uint8_t kVersion1 = 5, kVersion2 = 0;
  if (data[0] != (protocol == Protocol::kSdk1 ? kVersion1 : kVersion2)) return false;
  if (protocol == Protocol::kSdk2) return Number(data + 1, 2) == size && data[10] != 0;
  // It has no length; each type comes in one size.
  constexpr std::size_t kMid40[] = {1300, 900};  // types 0 and 1
  if (!type) return data[9] < 2 && body == kMid40[data[9]];
  constexpr std::size_t kBeams[] = {0, 96, 48, 30};  // by the returns of each
  return body == kBeams[type->returns] * type->BeamBytes();
}

Packet Decode(Protocol protocol, const std::uint8_t* data, std::size_t size) {
  if (!IsPacket(protocol, data, size)) {
    throw InputError("a datagram of " + std::to_string(size) + " bytes is no packet of a Livox");
  }
  const int number = TypeNumber(protocol, data);
  const auto type = TypeOf(protocol, number);
  if (!type) {
    throw InputError("Livox packet: its points are of type " + std::to_string(number) +
                     "; expected " +
                     (protocol == Protocol::kSdk1 ? "2 to 5, 7 or 8 (Avia)" : "1, 2 or 3"));
  }
  const std::size_t body = size - HeadBytes(protocol), beams = body / type->BeamBytes();
  const bool told = protocol == Protocol::kSdk1 || Number(data + 5, 2) == beams;
  if (!told || beams == 0 || beams > kMostBeams || body % type->BeamBytes() != 0) {
    throw InputError(
        "Livox packet: " + std::to_string(body) + " bytes of points do not hold " +
        (told ? "whole points" : std::to_string(Number(data + 5, 2)) + " of them, as it says"));
  }
  Packet packet;
  ReadStamp(protocol, data, &packet);
  packet.beams = static_cast<int>(beams);
  packet.duration_us = protocol == Protocol::kSdk1 ? kBeam1_us * static_cast<double>(beams - 1)
                                                   : 0.1 * static_cast<double>(Number(data + 3, 2));
  const double step_us = beams > 1 ? packet.duration_us / static_cast<double>(beams - 1) : 0;
  for (std::size_t i = 0; i < beams; ++i) {
    bool noise = false;
    const auto best = BestOf(*type, data + HeadBytes(protocol) + i * type->BeamBytes(), &noise);
    if (best) {
      packet.points.push_back({best->place_m, best->reflectivity,
                               static_cast<float>(step_us * static_cast<double>(i))});
    } else if (noise) {
      ++packet.dropped;
    }
  }
  return packet;
}

}  // namespace rgbdt::livox
